#!/usr/bin/python3
"""What tools/scans measures and judges of tet meshes, on meshes whose numbers are known. usage: tests/scans/judging_test.py"""
import pathlib
import sys
import tempfile
import unittest

import meshio
import numpy as np

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parents[2] / "tools/scans"))
import judging  # noqa: E402
import results  # noqa: E402
import sweep  # noqa: E402
import tet_mesh  # noqa: E402
from judging import REFUSED, RIGHT, WRONG, Expected  # noqa: E402

KUHN = np.array([[0, 1, 3, 7], [0, 3, 2, 7], [0, 2, 6, 7], [0, 6, 4, 7], [0, 4, 5, 7], [0, 5, 1, 7]])  # of a cube


def blocks(cells):
    """Tets of unit cubes at whole numbers, which share their vertices."""
    corner = np.array([[i, j, k] for k in (0, 1) for j in (0, 1) for i in (0, 1)])
    places = np.concatenate([np.asarray(cell) + corner for cell in cells])
    points, at = np.unique(places, axis=0, return_inverse=True)
    tets = at.reshape(-1, 8)[:, KUHN].reshape(-1, 4)
    return tet_mesh.TetMesh(points.astype(float), tets, {})


def grid(n, m, k, holes=()):
    return [(x, y, z) for x in range(n) for y in range(m) for z in range(k) if (x, y, z) not in holes]


BAR = blocks(grid(6, 1, 1))
RING = blocks(grid(3, 3, 1, [(1, 1, 0)]))
SHELL = blocks(grid(3, 3, 3, [(1, 1, 1)]))


class Measures(unittest.TestCase):
    def numbers(self, mesh):
        m = judging.measured(mesh)
        return round(m.volume, 12), m.bodies, m.pieces, m.genus

    def test_bodies_of_cubes(self):
        self.assertEqual(self.numbers(BAR), (6, 1, 1, 0))
        self.assertEqual(self.numbers(RING), (8, 1, 1, 1))
        self.assertEqual(self.numbers(SHELL), (26, 1, 2, 0))
        self.assertEqual(self.numbers(blocks([(0, 0, 0), (3, 0, 0)])), (2, 2, 2, 0))

    def test_cubes_that_share_an_edge_have_no_manifold(self):
        m = judging.measured(blocks([(0, 0, 0), (1, 1, 0)]))
        self.assertEqual((m.bodies, m.genus), (2, None))

    def test_quality_is_one_for_a_regular_tet_and_negative_for_an_inverted_one(self):
        regular = np.array([[1, -1, -1], [1, 1, 1], [-1, 1, -1], [-1, -1, 1.]])
        q = [tet_mesh.mean_ratios(tet_mesh.TetMesh(regular, np.array([t]), {}))[0] for t in ([0, 1, 2, 3], [1, 0, 2, 3])]
        np.testing.assert_allclose(np.sort(q), [-1, 1])

    def test_faces_look_outward_whatever_the_numbering(self):
        turned = BAR._replace(tets=np.where(np.arange(len(BAR.tets))[:, None] % 2, BAR.tets, BAR.tets[:, [1, 0, 2, 3]]))
        for mesh in (BAR, turned):
            self.assertAlmostEqual(tet_mesh.enclosed_volume(mesh.points, tet_mesh.boundary(mesh)), 6)

    def test_open_triangles_are_closed_in_the_plane_of_their_rim(self):
        faces = tet_mesh.boundary(BAR)
        left = faces[~(BAR.points[faces][:, :, 0] == 6).all(1)]  # without one end
        self.assertEqual(len(tet_mesh.rims(left)), 1)
        self.assertEqual(len(tet_mesh.rims(faces)), 0)
        self.assertIsNone(tet_mesh.surface(left).genus)
        far = BAR.points + 1000
        self.assertAlmostEqual(tet_mesh.enclosed_volume(*tet_mesh.closed_flat(far, left)), 6)

    def test_what_no_sample_is_near_is_guessed(self):
        m = judging.measured(blocks(grid(40, 4, 4)))
        random = np.random.default_rng(1)
        x = random.uniform(0, 1, (20000, 3)) * [40, 4, 4]
        side = random.integers(0, 4, len(x))
        x[np.arange(len(x)), 1 + side // 2] = 4 * (side % 2)
        self.assertLess(judging.guessed_share(m, x), .06)  # the ends
        self.assertAlmostEqual(judging.guessed_share(m, x[x[:, 0] < 20]), .5, delta=.1)

    def test_files_are_read_with_their_data(self):
        with tempfile.TemporaryDirectory() as folder:
            file = pathlib.Path(folder) / "3-mesh/mesh.vtu"
            self.assertIsNone(judging.measured_case(folder))
            file.parent.mkdir()
            meshio.write(file, meshio.Mesh(BAR.points, [("tetra", BAR.tets)], {"heat": BAR.points[:, 0]}))
            m = judging.measured_case(folder)
            self.assertAlmostEqual(m.volume, 6)
            np.testing.assert_allclose(m.data["heat"], BAR.points[:, 0])


class Judges(unittest.TestCase):
    def judge(self, expected, mesh=BAR, code=0, seconds=1., says="", plain=True):
        return judging.judge(expected, code, seconds, says, mesh and judging.measured(mesh), plain)

    def test_a_mesh_is_right_or_all_that_is_wrong_is_named(self):
        self.assertEqual(self.judge(Expected(volume=6.01, genus=0, pieces=1, bodies=1)).result, RIGHT)
        wrong = self.judge(Expected(volume=6.5, genus=1, tets=10, seconds=.5))
        self.assertEqual(wrong.result, WRONG)
        for word in ("volume -7.69 %", "genus 0, not 1", "36 tets, over 10", "1.0 s, over 0.5"):
            self.assertIn(word, wrong.reason)

    def test_codes(self):
        refuse = Expected(codes=(), refused=(3, 4), says="sheet")
        self.assertEqual(self.judge(refuse, None, 3, says="a sheet is no body").result, REFUSED)
        self.assertEqual(self.judge(refuse, None, 3, says="bad file").result, WRONG)
        self.assertEqual(self.judge(refuse, BAR, 0).result, WRONG)
        self.assertEqual(self.judge(Expected(), BAR, 6).reason, "exit 6")
        either = Expected(genus=0, refused=(6,), says="handle")
        self.assertEqual(self.judge(either, RING, 6, says="3 handles without samples").result, REFUSED)
        self.assertEqual(self.judge(either, BAR, 0).result, RIGHT)
        self.assertEqual(self.judge(either, RING, 0).result, WRONG)
        self.assertEqual(self.judge(Expected(), None, 0).reason, "no mesh")

    def test_sharp_edges_are_a_judgement_of_their_own(self):
        corners = np.array([[0, 0, 0], [6, 1, 1.]])
        self.assertEqual(self.judge(Expected(volume=6, corners=corners, tight=.001)).edges, "kept")
        lost = self.judge(Expected(volume=6, corners=corners + .3, tight=.001))
        self.assertEqual((lost.result, lost.edges), (RIGHT, "lost"))
        self.assertEqual(self.judge(Expected()).edges, "")

    def test_box_and_flat_openings(self):
        box = (np.zeros(3), np.array([6., 1, 1]))
        opening = (np.array([6, .5, .5]), np.array([1., 0, 0]), 1.)
        self.assertEqual(self.judge(Expected(box=box, flat=[opening])).result, RIGHT)
        self.assertIn("the box is off by 1", self.judge(Expected(box=(box[0], box[1] + [1, 0, 0]))).reason)
        dome = BAR._replace(points=BAR.points + .6 * (BAR.points[:, :1] == 6) * np.array([1, 0, 0]))
        self.assertIn("off its plane", self.judge(Expected(flat=[opening]), dome).reason)

    def test_fields(self):
        mesh = BAR._replace(data={"red": np.full(len(BAR.points), 120)})
        self.assertEqual(self.judge(Expected(values=[("colour", lambda a: (a == 120).all())]), mesh).result, RIGHT)
        self.assertIn("no field of", self.judge(Expected(values=[("heat", lambda a: (a == 1).all())]), mesh).reason)

    def test_what_is_guessed_is_no_plain_pass(self):
        samples = np.random.default_rng(2).uniform(0, 1, (2000, 3)) * [1, 1, 1]
        self.assertIn("guessed", self.judge(Expected(samples=samples)).reason)
        self.assertEqual(self.judge(Expected(samples=samples), plain=False).result, RIGHT)


class Tables(unittest.TestCase):
    def test_a_table_goes_on_where_it_was_left(self):
        with tempfile.TemporaryDirectory() as folder:
            file = pathlib.Path(folder) / "out/rows.csv"
            table = results.Rows(file, ["file", "exit"])
            table.add({"file": "a, b", "exit": 0})
            again = results.Rows(file, ["file", "exit", "seconds"])
            self.assertIn("a, b", again)
            again.add({"file": "c", "exit": 6, "seconds": "1.5"})
            self.assertEqual([row["exit"] for row in results.Rows(file, again.columns)], ["0", "6"])
            self.assertEqual(again.markdown().splitlines()[2], "| a, b | 0 | - |")

    def test_the_truth_of_triangles_in_a_file(self):
        with tempfile.TemporaryDirectory() as folder:
            file = pathlib.Path(folder) / "ring.stl"
            meshio.write(file, meshio.Mesh(RING.points, [("triangle", tet_mesh.boundary(RING))]))
            volume, genus = sweep.truth(file)
            self.assertAlmostEqual(volume, 8, places=5)
            self.assertEqual(genus, 1)
            self.assertEqual(sweep.files_below(folder), [file])
            self.assertEqual(sweep.truth(pathlib.Path("cloud.xyz")), (None, None))


if __name__ == "__main__":
    unittest.main()
