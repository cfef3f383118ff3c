#!/usr/bin/python3
"""The Python module, from outside. PYTHONPATH has the folder of umtet/; usage: umtet_test.py"""
import doctest
import importlib.util
import json
import os
import pathlib
import shutil
import signal
import subprocess
import sys
import tempfile
import threading
import time
import types
import unittest

import numpy as np
import umtet

BALL = "x^2+y^2+z^2-1"
BOX = (-1.3, -1.3, -1.3, 1.3, 1.3, 1.3)


def ball(x):
    return (x**2).sum(1) - 1, 2 * x, np.broadcast_to(2 * np.eye(3), (len(x), 3, 3))


def egg(n=2000, axes=(1, .8, .6)):
    """Points of an ellipsoid on a spiral, and their normals."""
    z = 1 - (2 * np.arange(n) + 1) / n
    r, a = np.sqrt(1 - z**2), 2.399963229728653 * np.arange(n)
    u = np.c_[r * np.cos(a), r * np.sin(a), z]
    m = u / axes
    return u * axes, m / np.linalg.norm(m, axis=1)[:, None]


class Reconstruct(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.points, cls.normals = egg()
        cls.psi = umtet.reconstruct(cls.points, cls.normals)

    def test_zero_set_is_the_surface(self):
        x, _ = egg(500)
        self.assertLess(abs(self.psi.value(x)).max(), 1e-3)
        self.assertLess(self.psi.value([[0, 0, 0]])[0], -.3)
        self.assertGreater(self.psi.value([[1.1, 0, 0]])[0], .05)

    def test_derivatives_are_those_of_the_values(self):
        x, d = np.array([[.9, .2, .1], [.1, .7, -.2]]), 1e-5
        for i, e in enumerate(np.eye(3) * d):
            np.testing.assert_allclose(self.psi.gradient(x)[:, i], (self.psi.value(x + e) - self.psi.value(x - e)) / 2 / d,
                                       atol=1e-7)
            np.testing.assert_allclose(self.psi.hessian(x)[:, i],
                                       (self.psi.gradient(x + e) - self.psi.gradient(x - e)) / 2 / d, atol=1e-5)

    def test_a_noisy_cloud_makes_the_mesh_that_its_file_makes(self):
        if "UMTET_PROGRAM" not in os.environ:
            self.skipTest("no program")
        points, normals = egg(4000)
        points = points * (1 + .05 * np.random.default_rng(1).standard_normal(4000))[:, None]
        for far in (0, 1e5):
            mesh = umtet.mesh(umtet.reconstruct(points + far, normals))
            with tempfile.TemporaryDirectory() as folder:
                np.savetxt(f"{folder}/egg.xyz", np.c_[points + far, normals], fmt="%.17g")
                subprocess.run([os.environ["UMTET_PROGRAM"], "run", f"{folder}/egg.xyz", "-o", f"{folder}/egg", "-q"],
                               check=True, capture_output=True)
                mesh.save(f"{folder}/ours.vtu")
                with open(f"{folder}/egg/3-mesh/mesh.vtu", "rb") as theirs, open(f"{folder}/ours.vtu", "rb") as ours:
                    self.assertTrue(ours.read() == theirs.read(), far)
            self.assertGreater(mesh.h, .1)  # noise decides it

    def test_far_from_the_origin_nothing_changes(self):
        far = np.array([1e6, -2e6, 3e6])
        psi = umtet.reconstruct(self.points + far, self.normals)
        x, _ = egg(50)
        np.testing.assert_allclose(psi.value(x + far), self.psi.value(x), atol=1e-6)
        mesh = umtet.mesh(psi, h=.2)
        self.assertLess(abs(mesh.points.mean(0) - far).max(), .1)

    def test_turned_normals_are_turned_back_and_said(self):
        n = self.normals.copy()
        n[::10] *= -1
        psi = umtet.reconstruct(self.points, n)
        self.assertIn("turned 200", psi.report["notices"][0])

    def test_meshed_with_certificate(self):
        mesh = umtet.mesh(self.psi, h=.1)
        self.assertTrue(mesh.certified, mesh.certificate["reasons"])
        self.assertEqual(mesh.certificate["n_points"], len(self.points))
        self.assertAlmostEqual(mesh.certificate["volume"], 4 / 3 * np.pi * .48, delta=.03)
        self.assertIsNotNone(mesh.certificate["cloud"])

    def test_holes_of_a_scan_are_named(self):
        self.assertEqual(umtet.mesh(self.psi, h=.15).certificate["domain"]["closed_holes"], [])
        points, normals = egg(5000)
        kept = points[:, 0] < .85
        mesh = umtet.mesh(umtet.reconstruct(points[kept], normals[kept]), h=.06)
        hole, = mesh.certificate["domain"]["closed_holes"]
        self.assertGreater(hole["centre"][0], .85)
        self.assertEqual(hole["rim"]["n"], 1)
        with tempfile.TemporaryDirectory() as folder:
            mesh.save(f"{folder}/egg.msh")
            with open(f"{folder}/egg.msh", "rb") as file:
                self.assertIn(b'"closed_holes"', file.read())

    def test_files_are_read_as_the_program_reads_them(self):
        with tempfile.TemporaryDirectory() as folder:
            file = pathlib.Path(folder) / "egg.csv"
            rows = np.c_[self.points, self.normals, np.arange(len(self.points)) * .5 - 3]
            np.savetxt(file, rows, fmt="%.17g", delimiter=";", header="X;Y;Z;Nx;Ny;Nz;Heat", comments="")
            psi = umtet.reconstruct(file)
            self.assertTrue(any("as the header says" in notice for notice in psi.report["notices"]))
            same = umtet.reconstruct(file, columns="x,y,z,nx,ny,nz")
            x = self.points[:7] * 1.01
            self.assertTrue(np.array_equal(psi.value(x), same.value(x)))
            self.assertTrue(np.allclose(psi.value(x), umtet.reconstruct(self.points, self.normals).value(x), rtol=1e-9))
            with self.assertRaisesRegex(umtet.ReconstructionError, "7 columns"):
                umtet.reconstruct(file, columns=["x", "y", "z", "-", "-", "-", "heat", "time"])
            with self.assertRaisesRegex(ValueError, "columns"):
                umtet.reconstruct(file, columns="x,y")
            with self.assertRaises(OSError):
                umtet.reconstruct(pathlib.Path(folder) / "none.csv")

    def test_no_body_is_a_reconstruction_error(self):
        with self.assertRaises(umtet.ReconstructionError) as e:
            umtet.reconstruct(self.points, -self.normals, normal_source="given")
        self.assertEqual(e.exception.evidence["status"], "SolveError")

    def test_only_coarse_is_kept_and_fails(self):
        m = umtet.mesh("x^2+y^2+4*z^2-1", box=(-6, -6, -6, 6, 6, 6), h=1.6)
        self.assertEqual(len(m.certificate["resolution"]["too_thin"]), 1)
        self.assertEqual(m.certificate["verdict"], "fail")
        self.assertEqual(len(m.certificate["reasons"]), 1)
        self.assertTrue(m.certificate["reasons"][0].startswith("volume_gap"))

    def test_broken_contracts(self):
        for arguments in ((self.points, self.normals[1:]), (self.points[:, :2], ), ([[np.nan, 0, 0]] * 20, )):
            with self.assertRaises(ValueError):
                umtet.reconstruct(*arguments)
        with self.assertRaisesRegex(ValueError, "detail"):
            umtet.reconstruct(self.points, self.normals, detail=-1)
        with self.assertRaisesRegex(TypeError, "pathlib.Path"):
            umtet.reconstruct("scan.ply")
        with self.assertRaisesRegex(TypeError, "columns"):
            umtet.reconstruct(self.points, columns="x,y,z")
        with self.assertRaisesRegex(TypeError, "detial"):
            umtet.reconstruct(self.points, self.normals, detial=1)


class MeshTest(unittest.TestCase):
    def test_arrays_of_a_mesh(self):
        m = umtet.mesh(BALL, box=BOX, h=.2)
        self.assertEqual((m.points.dtype, m.points.shape[1]), (np.float64, 3))
        self.assertEqual(m.tets.shape, (m.certificate["n_tets"], 4))
        a, b, c, d = (m.points[m.tets[:, k]] for k in range(4))
        volumes = np.einsum("ij,ij->i", np.cross(b - a, c - a), d - a) / 6
        self.assertGreater(volumes.min(), 0)
        self.assertAlmostEqual(volumes.sum(), m.certificate["volume"])
        np.testing.assert_allclose(np.linalg.norm(m.points[np.unique(m.boundary)], axis=1), 1, atol=1e-9)
        np.testing.assert_array_equal(np.unique(m.boundary), m.boundary_vertices)
        self.assertEqual(len(m.background_vertex), len(m.points))
        self.assertEqual(len(m.background_tet), len(m.tets))
        self.assertTrue((np.diff(m.background_tet) > 0).all())

    def test_a_formula_with_sharp_edges_has_them_in_its_mesh(self):
        m = umtet.mesh("max(x^2+y^2-1,abs(z)-1)", box=(-1.5, -1.5, -1.5, 1.5, 1.5, 1.5), h=.2)
        features = m.certificate["features"]
        self.assertEqual((features["curves"], features["corners"], features["patches"]), (2, 0, 3))
        self.assertEqual(features["missed_curves"], 0)
        self.assertEqual(m.certificate["verdict"], "pass")
        rim = m.points[np.isclose(np.hypot(m.points[:, 0], m.points[:, 1]), 1) & np.isclose(abs(m.points[:, 2]), 1)]
        self.assertGreater(len(rim), 40)

    def test_certificate_has_the_keys_of_the_file(self):
        if "UMTET_PROGRAM" not in os.environ:
            self.skipTest("no program")
        with tempfile.TemporaryDirectory() as folder:
            os.system(f"'{os.environ['UMTET_PROGRAM']}' mesh --implicit '{BALL}' --box={','.join(map(str, BOX))} --h .2 "
                      f"-o {folder}/ball -q >/dev/null")
            with open(f"{folder}/ball/certificate.json") as file:
                written = json.load(file)
        ours = umtet.mesh(BALL, box=BOX, h=.2).certificate
        self.assertEqual(set(written) - set(ours) - {"run", "checksum"}, set())
        for key in ("quality", "boundary", "volume", "n_tets"):
            self.assertEqual(ours[key], written[key])

    def test_a_callable_makes_the_mesh_of_the_formula(self):
        # At this h no tet is repaired: which of two flips as good is taken hangs on rounding.
        formula, called = umtet.mesh(BALL, box=BOX, h=.25), umtet.mesh(ball, box=BOX, h=.25)
        np.testing.assert_array_equal(formula.tets, called.tets)
        np.testing.assert_allclose(formula.points, called.points, atol=1e-8)
        self.assertTrue(called.certified)

    def test_blocks_make_the_mesh_that_points_make(self):
        # The same arithmetic, so that each value has the same bits.
        def torus(x, y, z):
            r = np.sqrt(x * x + y * y)
            return (r - 1) * (r - 1) + z * z - .16

        box = (-1.7, -1.7, -.7, 1.7, 1.7, .7)
        for parameters in ({"h": .25}, {"h": .3, "order": 2}, {"h": .35, "mode": "paper"}, {"max_deviation": .05}, {"tets": 2000},
                           {"h": .3, "size": ".3+.1*x", "background": "graded"}):
            by_block = umtet.mesh(lambda x: torus(x[:, 0], x[:, 1], x[:, 2]), box=box, **parameters)
            by_point = umtet.mesh(lambda x: torus(x[0], x[1], x[2]), box=box, **parameters)
            self.assertEqual(by_block.points.tobytes(), by_point.points.tobytes(), parameters)
            np.testing.assert_array_equal(by_block.tets, by_point.tets)
            self.assertEqual(by_block.certificate["resolution"], by_point.certificate["resolution"])
            self.assertTrue(by_block.certified, by_block.certificate["reasons"])
        moving = [umtet.UniversalMesh((-1, -1, -1, 2, 1, 1), h=.2) for _ in range(2)]
        for t in (0, .1, .2):
            blocks, points = (m.update(psi, certify=True).mesh for m, psi in zip(moving, (
                lambda x: (x[:, 0] - t) * (x[:, 0] - t) + x[:, 1] * x[:, 1] + x[:, 2] * x[:, 2] - .3,
                lambda x: (x[0] - t) * (x[0] - t) + x[1] * x[1] + x[2] * x[2] - .3)))
            self.assertEqual(blocks.points.tobytes(), points.points.tobytes())

    def test_blocks_are_large(self):
        sizes = []

        def psi(x):
            sizes.append(len(x))
            return (x**2).sum(1) - 1

        umtet.mesh(psi, box=BOX, h=.1)
        self.assertGreater(sum(sizes), 500000)
        self.assertLess(len(sizes), sum(sizes) / 500)

    def test_a_callable_may_take_one_point(self):
        block = umtet.mesh(ball, box=BOX, h=.4)
        for psi in (lambda p: p @ p - 1, lambda p: sum(c * c for c in p) - 1, lambda p: (p @ p - 1, 2 * p),
                    lambda p: (float(p @ p - 1), list(2 * p), 2 * np.eye(3))):
            m = umtet.mesh(psi, box=BOX, h=.4)
            np.testing.assert_array_equal(m.tets, block.tets)
            np.testing.assert_allclose(m.points, block.points, atol=1e-7)
        with self.assertRaisesRegex(ZeroDivisionError, "by zero"):
            umtet.mesh(lambda p: 1 / 0, box=BOX, h=.4)

    def test_missing_derivatives_are_made(self):
        whole = umtet.mesh(ball, box=BOX, h=.25)
        for psi in (lambda x: ball(x)[:2], lambda x: ball(x)[0]):
            made = umtet.mesh(psi, box=BOX, h=.25)
            self.assertTrue(made.certified, made.certificate["reasons"])
            np.testing.assert_allclose(made.points, whole.points, atol=1e-6)
            self.assertAlmostEqual(made.certificate["resolution"]["kappa_h_max"],
                                   whole.certificate["resolution"]["kappa_h_max"], places=4)

    def test_curved_tets_have_ten_nodes_on_the_corners_of_the_straight_ones(self):
        straight, m = umtet.mesh(BALL, box=BOX, h=.3), umtet.mesh(BALL, box=BOX, h=.3, order=2)
        n = len(straight.points)
        np.testing.assert_array_equal(m.tets[:, :4], straight.tets)
        np.testing.assert_array_equal(m.points[:n], straight.points)
        np.testing.assert_array_equal(m.boundary[:, :3], straight.boundary)
        self.assertEqual((m.tets.shape[1], m.boundary.shape[1]), (10, 6))
        self.assertEqual(m.certificate["order"], 2)
        self.assertTrue(m.certified, m.certificate["reasons"])
        np.testing.assert_allclose(np.linalg.norm(m.points[np.unique(m.boundary)], axis=1), 1, atol=1e-9)
        np.testing.assert_array_equal(np.unique(m.boundary), m.boundary_vertices)
        self.assertEqual(len(m.background_vertex), len(m.points))
        self.assertTrue((m.background_vertex[:n] >= 0).all() and (m.background_vertex[n:] == -1).all())
        # Mid-sides are where the element has them: near the middles of their edges, for tets and for faces.
        h = m.h
        for elements, edges in ((m.tets, ((0, 1), (1, 2), (2, 0), (0, 3), (1, 3), (2, 3))), (m.boundary, ((0, 1), (1, 2),
                                                                                                         (2, 0)))):
            first = elements.shape[1] - len(edges)
            for k, (p, q) in enumerate(edges):
                middle = (m.points[elements[:, p]] + m.points[elements[:, q]]) / 2
                self.assertLess(np.linalg.norm(m.points[elements[:, first + k]] - middle, axis=1).max(), .2 * h)
        volume = 4 / 3 * np.pi
        self.assertLess(abs(m.certificate["second_order"]["volume"] - volume), .05 * abs(straight.certificate["volume"] - volume))
        with tempfile.TemporaryDirectory() as folder:
            for suffix in ("vtu", "msh", "mesh", "stl"):
                m.save(os.path.join(folder, "ball." + suffix))
                self.assertGreater(os.path.getsize(os.path.join(folder, "ball." + suffix)), 1000)
        with self.assertRaisesRegex(TypeError, "order"):
            umtet.UniversalMesh(BOX, h=.2, order=2)

    def test_one_level_set_many_meshes(self):
        psi = umtet.reconstruct(*egg())
        coarse, fine = umtet.mesh(psi, h=.3), umtet.mesh(psi, h=.1)
        self.assertGreater(len(fine.tets), 10 * len(coarse.tets))
        np.testing.assert_array_equal(umtet.mesh(psi, h=.3).points, coarse.points)

    def test_threads_do_not_change_a_bit(self):
        one, two = (umtet.mesh(BALL, box=BOX, h=.1, threads=n) for n in (1, 2))
        self.assertEqual(one.points.tobytes(), two.points.tobytes())

    def test_python_threads_work_side_by_side(self):
        made = [None] * 3

        def work(k):
            made[k] = umtet.mesh(ball if k else BALL, box=BOX, h=.3)

        threads = [threading.Thread(target=work, args=(k, )) for k in range(3)]
        for t in threads:
            t.start()
        for t in threads:
            t.join(120)
        self.assertTrue(all(m is not None and m.certified for m in made))

    def test_a_number_of_tets_far_from_its_estimate_is_met(self):
        mesh = umtet.mesh(BALL, box=(-9, -9, -9, 9, 9, 9), tets=600)  # .86 and 1.7 times as many at the first two h
        self.assertLess(abs(len(mesh.tets) / 600 - 1), .1)

    def test_save(self):
        m = umtet.mesh(BALL, box=BOX, h=.3)
        with tempfile.TemporaryDirectory() as folder:
            for suffix in ("vtu", "msh", "mesh", "stl"):
                path = os.path.join(folder, "ball." + suffix)
                m.save(path)
                self.assertGreater(os.path.getsize(path), 1000)
            with self.assertRaisesRegex(ValueError, ".vtu, .msh"):
                m.save(os.path.join(folder, "ball.obj"))
            with self.assertRaises(OSError):
                m.save(os.path.join(folder, "no", "ball.vtu"))


class SeveralBodies(unittest.TestCase):
    BOX = (-2, -2, -2, 2, 2, 2)

    def test_formulas_make_the_mesh_of_the_program(self):
        bodies = {"shell": BALL, "core": "x^2+y^2+z^2-.3"}
        made = umtet.mesh_regions(bodies, box=self.BOX, tets=30000)
        self.assertTrue(made.certified, made.certificate["reasons"])
        self.assertEqual(made.names, ["outside", "shell", "core"])
        self.assertEqual(len(made.region), len(made.tets))
        x = made.points[made.tets]
        volumes = np.einsum("ij,ij->i", np.cross(x[:, 1] - x[:, 0], x[:, 2] - x[:, 0]), x[:, 3] - x[:, 0]) / 6
        for region in made.certificate["regions"]:
            self.assertAlmostEqual(volumes[made.region == region["region"]].sum(), region["volume"], 9)
        self.assertEqual({name: len(faces) for name, faces in made.patches().items() if name != "walls"},
                         {i["name"]: i["faces"] for i in made.certificate["interfaces"]})
        if "UMTET_PROGRAM" not in os.environ:
            self.skipTest("no program")
        with tempfile.TemporaryDirectory() as folder:
            words = [f"{name}={formula}" for name, formula in bodies.items()]
            subprocess.run([os.environ["UMTET_PROGRAM"], "regions", *words, "--box=-2,-2,-2,2,2,2", "--tets", "30000", "-q",
                            "-o", folder, "--export", "inp"], check=True, stdout=subprocess.DEVNULL)
            self.assertEqual(json.loads(pathlib.Path(folder, "regions.json").read_text()), made.certificate)
            made.save(pathlib.Path(folder, "mine.inp"))
            self.assertEqual(pathlib.Path(folder, "mine.inp").read_bytes(),
                             pathlib.Path(folder, "4-export/mesh.inp").read_bytes())

    def test_level_sets_and_callables(self):
        points, normals = egg()
        made = umtet.mesh_regions({"egg": umtet.reconstruct(points, normals), "core": lambda x: (x**2).sum(1) - .09},
                                  box=self.BOX, tets=100000, outside=False)
        self.assertTrue(made.certified, made.certificate["reasons"])
        self.assertEqual(set(made.region), {1, 2})
        self.assertEqual(set(made.patches()), {"egg|core", "egg|outside"})
        self.assertEqual(made.certificate["samples"][0]["missed"], 0)

    def test_broken_contracts(self):
        def mesh(bodies, **arguments):
            return umtet.mesh_regions(bodies, **{"box": self.BOX, "h": .3, **arguments})

        for bodies in ({"walls": BALL}, {"1": BALL}, {"outside": BALL}, {"a": BALL, "A": BALL}, {}):
            with self.assertRaises(ValueError, msg=bodies):
                mesh(bodies)
        with self.assertRaises(ValueError):
            mesh({"a": BALL}, box=None)
        with self.assertRaises(TypeError):
            mesh({"a": 3})
        with self.assertRaises(umtet.MeshingError):
            mesh({"a": "x^2+y^2+z^2-9"})
        with self.assertRaises(ValueError):
            mesh({"a": BALL}).save("a.stl")


class Failures(unittest.TestCase):
    def test_too_small_a_box_has_evidence(self):
        with self.assertRaises(umtet.MeshingError) as e:
            umtet.mesh(BALL, box=(-1, -1, -1, .2, 1, 1), h=.2)
        self.assertEqual(e.exception.evidence["h"], .2)
        self.assertIn("status", e.exception.evidence)

    def test_too_thin_has_places(self):
        m = umtet.mesh("(x^2+y^2)/1+z^2/.0016-1", box=(-1.5, -1.5, -1.5, 1.5, 1.5, 1.5), h=.3)
        self.assertFalse(m.certified)
        self.assertTrue(m.certificate["boundary"]["embedded"])
        self.assertLess(m.certificate["resolution"]["too_thin"][0]["h_needed"], .3)

    def test_broken_contracts(self):
        with self.assertRaisesRegex(ValueError, "box"):
            umtet.mesh(BALL, h=.2)
        with self.assertRaisesRegex(ValueError, "column"):
            umtet.mesh("x^^2", box=BOX, h=.2)
        with self.assertRaises(TypeError):
            umtet.mesh(3, box=BOX, h=.2)
        with self.assertRaisesRegex(ValueError, "mode"):
            umtet.mesh(BALL, box=BOX, mode="fats")
        with self.assertRaisesRegex(ValueError, "points \\(n, 3\\)"):
            umtet.mesh(lambda x: np.zeros(len(x) + 1), box=BOX, h=.2)
        with self.assertRaisesRegex(ValueError, "not an array of numbers"):
            umtet.mesh(lambda x: None, box=BOX, h=.2)
        with self.assertRaisesRegex(ValueError, "finite"):
            umtet.mesh("x^2+y^2+z^2-t", box=BOX, h=.2, t=np.nan)

    def test_what_psi_raises_comes_out(self):
        # In a block of values, and in the middle of searches that wait for each other.
        for last in (5, 100, 200):
            calls = []

            def psi(x):
                calls.append(len(x))
                if len(calls) > last:
                    raise KeyError("of psi")
                return (x**2).sum(1) - 1

            with self.assertRaisesRegex(KeyError, "of psi"):
                umtet.mesh(psi, box=BOX, h=.2)
            self.assertEqual(len(calls), last + 1)

    def test_a_grid_of_a_file_is_meshed_and_bad_ones_are_value_errors(self):
        grid = np.stack(np.meshgrid(*3 * [np.linspace(-1.3, 1.3, 24)], indexing="ij"), -1)
        head = ("NRRD0004\ntype: uchar\ndimension: 3\nsizes: 24 24 24\nencoding: raw\n"
                f"spacings: {3 * (str(2.6 / 23) + ' ')}\n\n").encode()
        with tempfile.TemporaryDirectory() as folder:
            path = pathlib.Path(folder, "ball.nrrd")
            path.write_bytes(head + (np.linalg.norm(grid, axis=-1) < 1).astype(np.uint8).tobytes(order="F"))
            m = umtet.mesh(path, h=.25)
            self.assertTrue(m.certified, m.certificate["reasons"])
            self.assertIn("smoothed between", m.notices[0])
            with self.assertRaisesRegex(ValueError, "there is no part 7; the parts are 1"):
                umtet.mesh(path, part=7, h=.25)
            path.write_bytes(head)
            with self.assertRaisesRegex(ValueError, "no room"):
                umtet.mesh(path, h=.25)

    def test_progress_stops(self):
        steps = []

        def progress(step, fraction):
            self.assertTrue(0 <= fraction <= 1, (step, fraction))
            steps.append(step)
            return step != "components"

        with self.assertRaises(umtet.Cancelled):
            umtet.mesh(BALL, box=BOX, h=.1, progress=progress)
        self.assertEqual(steps[-1], "components")
        with self.assertRaises(umtet.Cancelled):
            umtet.mesh(BALL, box=BOX, h=.1, progress=lambda step, fraction: np.float64(fraction) < 0)
        points, normals = egg()
        steps.clear()
        umtet.reconstruct(points, normals, progress=lambda step, fraction: steps.append(step))
        self.assertIn("solve", steps)

    def test_ctrl_c_within_a_fifth_of_a_second(self):
        cloud = egg(100000)
        for after, job in ((.5, lambda: umtet.mesh(BALL, box=BOX, h=.02, max_tets=10**7)),
                           (.5, lambda: umtet.mesh(ball, box=BOX, h=.03)), (.1, lambda: umtet.reconstruct(*cloud))):
            pressed = []

            def press():
                pressed.append(time.monotonic())
                os.kill(os.getpid(), signal.SIGINT)

            timer = threading.Timer(after, press)
            self.addCleanup(timer.cancel)
            timer.start()
            with self.assertRaises(KeyboardInterrupt):
                job()
            self.assertLess(time.monotonic() - pressed[0], PATIENCE)
            timer.join()


# Wall time is what is asked for; a machine with more to do than cores gets longer.
PATIENCE = .2 * max(1, os.getloadavg()[0] / os.cpu_count())


class Moving(unittest.TestCase):
    def test_ids_are_those_of_one_background(self):
        moving = umtet.UniversalMesh((-1, -1, -1, 3, 1, 1), h=.2)
        psi = "(x-2*t)^2+y^2+z^2-(.5+.2*t)^2"
        last = None
        for t in (0, .1, .2):
            update = moving.update(psi, t=t, certify=True)
            self.assertTrue(update.mesh.certified)
            if last is not None:
                before, now = set(last.mesh.background_tet.tolist()), set(update.mesh.background_tet.tolist())
                self.assertEqual(set(update.tets_entered.tolist()), now - before)
                self.assertEqual(set(update.tets_left.tolist()), before - now)
            last = update
        self.assertIsNone(moving.update(psi, t=.2).mesh.certificate)
        self.assertLess(last.mesh.background_vertex.max(), moving.n_background_vertices)

    def test_the_fluid_around_a_body_moves(self):
        box = (-2, -2, -2, 2.5, 2, 2)
        moving = umtet.UniversalMesh(box, h=.25, complement=True, box_walls=True)
        for x in (0, .3):
            update = moving.update("(x-t)^2+y^2+z^2-1", t=x, certify=True)
            self.assertTrue(update.mesh.certified, update.mesh.certificate["reasons"])
            self.assertAlmostEqual(update.mesh.certificate["volume"], 4.5 * 16 - 4 / 3 * np.pi, delta=.3)
        alone = umtet.mesh(BALL, box=box, h=.25, complement=True, box_walls=True)
        self.assertTrue(alone.certified, alone.certificate["reasons"])
        at_walls = alone.points[np.unique(alone.walls)]
        self.assertTrue(((at_walls == np.array(box[:3])) | (at_walls == np.array(box[3:]))).any(1).all())
        with self.assertRaisesRegex(ValueError, "^complement needs box_walls: .* of box$"):  # no flags
            umtet.UniversalMesh(box, h=.25, complement=True)

    def test_a_failed_update_leaves_the_last(self):
        moving = umtet.UniversalMesh(BOX, h=.2)
        n = len(moving.update(BALL).mesh.tets)
        with self.assertRaises(umtet.MeshingError):
            moving.update("(x-1)^2+y^2+z^2-1")
        self.assertEqual(len(moving.update(ball).mesh.tets), n)

    def test_broken_contracts(self):
        with self.assertRaises(ValueError):
            umtet.UniversalMesh(BOX, h=-1)
        with self.assertRaises(ValueError):
            umtet.UniversalMesh((0, 0, 0, 1), h=.1)
        with self.assertRaisesRegex(TypeError, "tets"):
            umtet.UniversalMesh(BOX, h=.1, tets=1000)
        points, normals = egg(500)
        with self.assertRaisesRegex(ValueError, "far from the origin"):
            umtet.UniversalMesh(BOX, h=.2).update(umtet.reconstruct(points + 1e6, normals))

    def test_one_call_at_a_time(self):
        moving, calls = umtet.UniversalMesh(BOX, h=.5), []

        def psi(x):
            calls.append(len(x))
            if len(calls) == 4:
                moving.update(BALL)
            return (x**2).sum(1) - 1

        with self.assertRaisesRegex(ValueError, "at work"):
            moving.update(psi)
        moving.update(BALL)


class Certificate(unittest.TestCase):
    def test_of_arrays(self):
        m = umtet.mesh(BALL, box=BOX, h=.2)
        c = umtet.certificate(m.points, m.tets, BALL, h=.2)
        for key in ("quality", "volume", "n_tets"):
            self.assertEqual(c[key], m.certificate[key])
        self.assertEqual(c["verdict"], "pass")
        tets = m.tets.copy()
        tets[0, :2] = tets[0, 1::-1]
        self.assertEqual(umtet.certificate(m.points, tets)["quality"]["n_inverted"], 1)
        self.assertEqual(umtet.certificate(m.points, tets)["verdict"], "fail")
        self.assertEqual(umtet.certificate(m.points, tets)["gates"]["min_quality"], None)
        self.assertFalse([r for r in umtet.certificate(m.points, tets)["reasons"] if "gate" in r])  # none was asked for
        self.assertEqual(umtet.certificate(m.points, m.tets, min_quality=.99)["verdict"], "fail")
        self.assertEqual(umtet.certificate(1.01 * m.points, m.tets, BALL, h=.2)["verdict"], "fail")
        with self.assertRaises(ValueError):
            umtet.certificate(m.points, m.tets + len(m.points))
        with self.assertRaisesRegex(TypeError, "integers"):
            umtet.certificate(m.points, m.tets + .3)


class OtherPackages(unittest.TestCase):
    """By their attributes, and by the packages that Debian has."""

    @classmethod
    def setUpClass(cls):
        cls.mesh = umtet.mesh(BALL, box=BOX, h=.3)
        cls.points, cls.normals = egg()
        # A closed surface of triangles in the order that Qhull has them, turned outward.
        try:
            from scipy.spatial import ConvexHull
        except ImportError as e:
            raise unittest.SkipTest(str(e))
        t = ConvexHull(cls.points).simplices
        a, b, c = (cls.points[t[:, k]] for k in range(3))
        turned = np.einsum("ij,ij->i", np.cross(b - a, c - a), a + b + c) < 0
        t[turned] = t[turned][:, ::-1]
        cls.triangles = t

    def psi_is_the_egg(self, thing, **arguments):
        psi = umtet.reconstruct(thing, **arguments)
        self.assertLess(abs(psi.value(self.points)).max(), .01)

    def test_clouds(self):
        x, n = self.points, self.normals
        self.psi_is_the_egg(types.SimpleNamespace(points=x, normals=n))  # Open3D
        self.psi_is_the_egg(types.SimpleNamespace(points=x, normals=[]))
        self.psi_is_the_egg(types.SimpleNamespace(points=x, point_data={"Normals": n}, faces=[]))  # pyvista
        self.psi_is_the_egg(types.SimpleNamespace(points=x), normals=n)

    def test_surface_meshes(self):
        x, t = self.points, self.triangles
        self.psi_is_the_egg(types.SimpleNamespace(vertices=x, triangles=t, vertex_normals=[]))  # Open3D
        self.psi_is_the_egg(types.SimpleNamespace(vertices=x, faces=t))  # trimesh
        self.psi_is_the_egg(types.SimpleNamespace(points=x, faces=np.c_[np.full(len(t), 3), t].ravel()))  # pyvista
        self.psi_is_the_egg(types.SimpleNamespace(points=x, cells_dict={"triangle": t}))  # meshio
        with self.assertRaisesRegex(ValueError, "triangulate"):
            umtet.reconstruct(types.SimpleNamespace(points=x, faces=[4, 0, 1, 2, 3]))

    def test_to_and_from_meshio(self):
        try:
            import meshio
        except ImportError as e:
            self.skipTest(str(e))
        m = self.mesh.to_meshio()
        np.testing.assert_array_equal(m.cells_dict["tetra"], self.mesh.tets)
        self.assertEqual(set(m.cell_sets), set(self.mesh.patches()))
        self.assertEqual(len(m.cell_sets_dict["boundary"]["triangle"]), len(self.mesh.boundary))
        self.assertEqual(umtet.certificate(m, psi=BALL, h=.3)["quality"], self.mesh.certificate["quality"])
        with tempfile.TemporaryDirectory() as folder:
            meshio.write_points_cells(f"{folder}/ball.vtk", m.points, m.cells)
            read = meshio.read(f"{folder}/ball.vtk")
        np.testing.assert_array_equal(read.points, self.mesh.points)
        curved = umtet.mesh(BALL, box=BOX, h=.4, order=2).to_meshio()
        self.assertEqual([b.type for b in curved.cells], ["tetra10", "triangle6"])

    def test_to_vtk_and_pyvista(self):
        try:
            import vtkmodules.vtkCommonDataModel  # noqa: F401
        except ImportError as e:
            self.skipTest(str(e))
        for mesh in (self.mesh, umtet.mesh(BALL, box=BOX, h=.4, order=2)):
            grid = mesh.to_vtk()
            self.assertEqual(grid.GetNumberOfCells(), len(mesh.tets))
            self.assertEqual([grid.GetCell(7).GetPointId(k) for k in range(mesh.tets.shape[1])], mesh.tets[7].tolist())
            self.assertEqual(grid.GetPoint(9), tuple(mesh.points[9]))
            self.assertEqual(grid.GetPointData().GetArray("background_vertex").GetValue(3), mesh.background_vertex[3])
        given = []
        sys.modules["pyvista"] = types.SimpleNamespace(wrap=lambda grid: given.append(grid) or "wrapped")
        self.addCleanup(sys.modules.pop, "pyvista")
        self.assertEqual(self.mesh.to_pyvista(), "wrapped")
        self.assertEqual(given[0].GetNumberOfCells(), len(self.mesh.tets))

    def test_patches_have_names(self):
        whole = self.mesh.patches()
        self.assertEqual([len(f) for f in whole.values()], [len(self.mesh.boundary)])
        self.assertEqual(sorted(map(sorted, next(iter(whole.values())).tolist())), sorted(map(sorted, self.mesh.boundary.tolist())))
        drum = umtet.mesh("(x^2+y^2)^4+z^8-1", box=BOX, h=.12).patches(patch_planar=4)
        self.assertEqual(set(drum), {"plane_1", "plane_2", "rest"})
        box = (-2, -2, -2, 2, 2, 2)
        around = umtet.mesh(BALL, box=box, h=.3, complement=True, box_walls=True)
        self.assertEqual(len(around.patches()["walls"]), len(around.walls))
        self.assertEqual(len(around.cells_dict["triangle"]), len(around.walls) + len(around.boundary))
        with self.assertRaisesRegex(TypeError, "patch_angel"):
            self.mesh.patches(patch_angel=30)

    def test_no_tets_are_a_type_error(self):
        with self.assertRaisesRegex(TypeError, "tets"):
            umtet.certificate(types.SimpleNamespace(points=self.points))


USER = """
import numpy as np
import numpy.typing as npt
import umtet

def ball(x: npt.NDArray[np.float64]) -> npt.NDArray[np.float64]:
    return np.asarray((x**2).sum(1) - 1)

mesh: umtet.Mesh = umtet.mesh(ball, box=(-2, -2, -2, 2, 2, 2), h=.2, order=2, progress=lambda step, part: part < .5)
n: int = len(mesh.tets) + len(mesh.patches(patch_angle=30)["boundary"])
psi: umtet.LevelSet = umtet.reconstruct(mesh.points, spacing=.1)
values: npt.NDArray[np.float64] = psi.value(mesh.points)
"""


class Processes(unittest.TestCase):
    """umtet.mesh(comm=...); tests/distributed/python_test.py has what it makes."""

    @unittest.skipIf(importlib.util.find_spec("umtet._distributed"), "built with MPI")
    def test_a_module_without_mpi_says_so(self):
        with self.assertRaisesRegex(ImportError, "built without MPI"):
            umtet.mesh(BALL, box=BOX, h=.3, comm=object())


class Types(unittest.TestCase):
    """mypy, of the hints, of what is behind them, and of a user's program; as Debian has it."""

    def mypy(self, *arguments, cwd):
        folder = os.path.dirname(os.path.dirname(umtet.__file__))
        return subprocess.run(["/usr/bin/python3", "-m", *arguments], cwd=cwd, capture_output=True, text=True,
                              env={**os.environ, "MYPYPATH": folder, "PYTHONPATH": folder})

    def setUp(self):
        if importlib.util.find_spec("mypy") is None:
            self.skipTest("no mypy")
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.folder = folder.name

    def test_the_package_is_strict(self):
        made = self.mypy("mypy", "--strict", "-p", "umtet", cwd=self.folder)
        self.assertEqual(made.returncode, 0, made.stdout)

    def test_the_stub_is_what_is_there(self):
        with open(f"{self.folder}/of_pybind", "w") as file:  # its metaclass, and objects that Python cannot make
            file.write("".join(f"umtet._core.{name}(.__init__)?\n" for name in ("LevelSet", "Mesh", "Moving", "RegionsMesh")))
        made = self.mypy("mypy.stubtest", "--allowlist", "of_pybind", "umtet._core", cwd=self.folder)
        self.assertEqual(made.returncode, 0, made.stdout)

    def test_a_program_of_a_user(self):
        with open(f"{self.folder}/user.py", "w") as file:
            file.write(USER)
        made = self.mypy("mypy", "--strict", "user.py", cwd=self.folder)
        self.assertEqual(made.returncode, 0, made.stdout)
        with open(f"{self.folder}/user.py", "a") as file:
            file.write("umtet.mesh(3)\nmesh.tetrahedra\n")
        made = self.mypy("mypy", "--strict", "user.py", cwd=self.folder)
        self.assertIn("Found 2 errors", made.stdout)


class Wheel(unittest.TestCase):
    def test_pip_makes_one_that_a_fresh_venv_imports(self):
        source, build = os.environ.get("UMTET_SOURCE"), os.environ.get("UMTET_BUILD")
        missing = [m for m in ("pip", "setuptools", "wheel", "venv") if importlib.util.find_spec(m) is None]
        if not source or missing:
            self.skipTest(f"no {missing or 'sources'}")
        with tempfile.TemporaryDirectory() as folder:
            subprocess.run(["/usr/bin/python3", "-m", "venv", "--system-site-packages", f"{folder}/venv"], check=True)
            # The sources are copied, so that nothing is left in them.
            for name in ("python", "pyproject.toml", "setup.py", "CMakeLists.txt", "LICENSE"):
                copy = shutil.copytree if os.path.isdir(f"{source}/{name}") else shutil.copy
                copy(f"{source}/{name}", f"{folder}/umtet/{name}" if copy is shutil.copytree else f"{folder}/umtet/")
            environment = {k: v for k, v in os.environ.items() if k != "PYTHONPATH"}
            made = subprocess.run([f"{folder}/venv/bin/pip", "install", "--no-build-isolation", "--no-deps", "--no-index", "."],
                                  cwd=f"{folder}/umtet", capture_output=True, text=True, env=environment)
            self.assertEqual(made.returncode, 0, made.stdout + made.stderr)
            program = ("import umtet; m = umtet.mesh('x^2+y^2+z^2-1', box=(-2,-2,-2,2,2,2), h=.5); "
                       "print(umtet.__file__, m.certified)")
            said = subprocess.run([f"{folder}/venv/bin/python", "-c", program], cwd=folder, capture_output=True, text=True,
                                  env=environment)
            self.assertEqual(said.stdout.split(), [said.stdout.split()[0], "True"], said.stderr)
            self.assertTrue(said.stdout.startswith(f"{folder}/venv/"), said.stdout)
            self.assertTrue(os.path.exists(os.path.dirname(said.stdout.split()[0]) + "/py.typed"))


class Documentation(unittest.TestCase):
    def test_the_example_makes_a_certified_mesh(self):
        if "UMTET_SOURCE" not in os.environ:
            self.skipTest("no sources")
        with tempfile.TemporaryDirectory() as folder:
            # A picture needs a display.
            program = f"import runpy; runpy.run_path({os.environ['UMTET_SOURCE']!r} + '/examples/python/gyroid.py')"
            said = subprocess.run([sys.executable, "-c", program, folder], capture_output=True, text=True, cwd=folder)
            self.assertIn("certified: True", said.stdout, said.stderr)
            self.assertEqual(sorted(os.listdir(folder)), ["gyroid.msh", "gyroid.vtu"])

    def test_the_examples_of_the_readme(self):
        with tempfile.TemporaryDirectory() as folder:
            here = os.getcwd()
            os.chdir(folder)
            try:
                failed, tried = doctest.testfile(os.environ["UMTET_PYTHON_README"], module_relative=False)
            finally:
                os.chdir(here)
        self.assertEqual(failed, 0)
        self.assertGreater(tried, 10)


if __name__ == "__main__":
    unittest.main()
