"""`mpirun -n N umtet_mpi` against `umtet`: the same files, and the same words where there is no mesh.

usage: program_test.py UMTET UMTET_MPI MPIEXEC N
"""

import json
import math
import os
import pathlib
import re
import shutil
import struct
import subprocess
import sys
import tempfile
import time
import unittest

UMTET, UMTET_MPI, MPIEXEC, N = sys.argv[1:5]
CLOUDS = pathlib.Path(__file__).resolve().parents[2] / "data/clouds"
CALLS = {
    "torus": ["--implicit", "(sqrt(x^2+y^2)-1)^2+z^2-.16", "--box=-1.6,-1.6,-.6,1.6,1.6,.6", "--h", ".08"],
    "two pieces, by tets": ["--implicit", "((x-1.3)^2+y^2+z^2-1)*((x+1.3)^2+y^2+z^2-1)", "--box=-2.6,-1.3,-1.3,2.6,1.3,1.3",
                            "--tets", "30000"],
    "tries another h": ["--implicit", "x^4+y^4+z^4-1.2*(x^2+y^2+z^2)+.6", "--box=-1.5,-1.5,-1.5,1.5,1.5,1.5", "--h", ".2"],
    "z tiling": ["--implicit", "x^2+2*y^2+3*z^2-1", "--box=-1.4,-1.4,-1.4,1.4,1.4,1.4", "--background", "z", "--h", ".1"],
    "second order": ["--implicit", "(sqrt(x^2+y^2)-1)^2+z^2-.16", "--box=-1.6,-1.6,-.6,1.6,1.6,.6", "--h", ".09", "--order", "2"],
    # Mid-sides are relaxed, and some go back to their chords.
    "second order, thin": ["--implicit", "x^4+y^4+z^4-1.2*(x^2+y^2+z^2)+.6", "--box=-1.5,-1.5,-1.5,1.5,1.5,1.5", "--h", ".13",
                           "--order", "2"],
    "too thin": ["--implicit", "x^2+y^2+900*z^2-1", "--box=-1.4,-1.4,-.4,1.4,1.4,.4", "--h", ".15"],
}


def run(command, folder, arguments, word="mesh"):
    return subprocess.run([*command, word, *arguments, "-o", str(folder), "--progress", "none"], capture_output=True,
                          text=True, timeout=300)


def of_ranks(folder, arguments, word="mesh"):
    return run([MPIEXEC, "-n", N, "--oversubscribe", UMTET_MPI], folder, arguments, word)


def with_a_rank(trouble, folder, arguments):
    """The last rank has trouble: a command of the shell that becomes the program."""
    script = f'if [ "$OMPI_COMM_WORLD_RANK" = {int(N) - 1} ]; then {trouble}; fi; exec "$@"'
    return run([MPIEXEC, "-n", N, "--oversubscribe", "sh", "-c", script, "sh", UMTET_MPI], folder, arguments)


# Runs what follows its first argument, and writes the most memory that it has held, in kB, to a file of the rank.
PEAK = """import os, resource, subprocess, sys
code = subprocess.run(sys.argv[2:]).returncode
with open(sys.argv[1] + os.environ["OMPI_COMM_WORLD_RANK"], "w") as file:
    file.write(str(resource.getrusage(resource.RUSAGE_CHILDREN).ru_maxrss))
sys.exit(code)"""


def node_data(file):
    """$NodeData of a binary .msh by name: whole numbers of its head, tags of nodes, their values."""
    import numpy
    found = {}
    for text in file.read_bytes().split(b"$NodeData\n")[1:]:
        lines = text.split(b"\n", 6)  # one name, one time, and how many whole numbers
        n = int(lines[4])
        *head, values = b"\n".join(lines[5:]).split(b"\n", n)
        head = [int(x) for x in head]
        rows = numpy.frombuffer(values, [("tag", "<i4"), ("value", "<f8", (head[1],))], head[2])
        found[lines[1].decode().strip('"')] = head, rows["tag"], rows["value"]
    return found


def ball(n, centre, radius):
    """Samples on a spiral: places and normals."""
    for i in range(n):
        z, a = 1 - (2 * i + 1) / n, math.pi * (1 + math.sqrt(5)) * i
        normal = (math.sqrt(1 - z * z) * math.cos(a), math.sqrt(1 - z * z) * math.sin(a), z)
        yield [c + radius * x for c, x in zip(centre, normal)] + list(normal)


def dumbbell():
    """Two balls and a thin rod between them."""
    ball_radius, rod, at, around = .4, .02, .8, 12
    for side in (-1, 1):
        for p in ball(4000, (side * at, 0, 0), ball_radius):
            if p[3] * side > 0 or math.hypot(p[1], p[2]) > rod:
                yield p
    end = at - math.sqrt(ball_radius**2 - rod**2)
    for ring in range(int(2 * end / .01)):
        for k in range(around):
            t = 2 * math.pi * (k + .5 * (ring % 2)) / around
            yield [-end + .01 * ring, rod * math.cos(t), rod * math.sin(t), 0, math.cos(t), math.sin(t)]


def write_cloud(file, points, fields=False, label=None):
    """@param label  an integer of a point: property `label`"""
    points = list(points)
    names = [f"double {n}" for n in ("x", "y", "z", "nx", "ny", "nz")]
    names += ["uchar red", "uchar green", "uchar blue", "float heat"] if fields else []
    names += ["int label"] if label else []
    lines = ["ply", "format ascii 1.0", f"element vertex {len(points)}", *(f"property {n}" for n in names), "end_header"]
    for i, p in enumerate(points):
        more = [i % 256, 7 * i % 256, 3 * i % 256, .5 * i] if fields else []
        lines.append(" ".join(map(repr, p + more + ([label(p)] if label else []))))
    file.write_text("\n".join(lines) + "\n")


def write_grid(file, n, value):
    """value(x, y, z) on n^3 nodes of the box from -1.3 to 1.3."""
    at = [-1.3 + 2.6 * i / (n - 1) for i in range(n)]
    head = (f"NRRD0004\ntype: float\ndimension: 3\nsizes: {n} {n} {n}\nencoding: raw\nendian: little\n"
            f"spacings: {at[1] - at[0]!r} {at[1] - at[0]!r} {at[1] - at[0]!r}\n"
            "space dimension: 3\nspace origin: (-1.3,-1.3,-1.3)\n\n")
    file.write_bytes(head.encode() + struct.pack(f"<{n**3}f", *(value(x, y, z) for z in at for y in at for x in at)))


def files_of(folder):
    return {f.relative_to(folder).as_posix() for f in folder.rglob("*") if f.is_file()}


def words(text, folder):
    """What a run says, without times and the words of mpirun."""
    text = text.replace(str(folder), "CASE").split("-----")[0]
    return [re.sub(r"[\d.]+ s$", "T s", line) for line in text.splitlines() if line.startswith(("umtet", "cloud", "level-set", "mesh", "  "))]


def without_run(file):
    document = json.loads(file.read_text())
    for name in ("run", "seal", "checksum"):
        document.pop(name, None)
    return document


class Program(unittest.TestCase):
    maxDiff = 2000

    def setUp(self):
        self.folder = pathlib.Path(tempfile.mkdtemp(prefix="umtet_program_"))

    def tearDown(self):
        shutil.rmtree(self.folder)

    def test_makes_the_files_of_one_process(self):
        for name, arguments in CALLS.items():
            with self.subTest(name):
                self.compare(arguments)

    def compare(self, arguments, word="mesh", also_says=()):
        """@param also_says: lines that several ranks add. @return what one process says"""
        one, all_ = self.folder / "one", self.folder / "all"
        a, b = run([UMTET], one, arguments, word), of_ranks(all_, arguments, word)
        self.assertEqual(a.returncode, b.returncode, b.stderr)
        said = words(b.stderr, all_)
        for line in also_says if N != "1" else ():
            self.assertIn(line, said)
            said.remove(line)
        self.assertEqual(words(a.stderr, one), said)
        files = sorted(f.relative_to(one) for f in one.rglob("*") if f.is_file())
        self.assertEqual(files, sorted(f.relative_to(all_) for f in all_.rglob("*") if f.is_file()))
        self.assertIn(pathlib.Path("3-mesh/mesh.vtu"), files)
        for file in files:
            if file.suffix in (".ply", ".vti", ".vtu", ".vtp", ".csv", ".toml"):
                self.assertTrue((one / file).read_bytes() == (all_ / file).read_bytes(), file)
        self.assertEqual(without_run(one / "certificate.json"), without_run(all_ / "certificate.json"))
        shutil.rmtree(one)
        shutil.rmtree(all_)
        return a.stderr

    def test_makes_the_files_of_one_process_of_a_cloud_in_second_order(self):
        cloud = self.folder / "fields.ply"
        write_cloud(cloud, ball(1500, (0, 0, 0), 1), fields=True)
        self.compare([str(cloud), "--h", ".15", "--order", "2"], "run")

    def test_evolves_as_one_process_does(self):
        clouds = self.folder / "clouds.txt"
        names = []
        for k in range(3):
            names.append(str(self.folder / f"ball_{k}.ply"))
            write_cloud(pathlib.Path(names[-1]), ball(1500, (.1 * k, 0, 0), 1 + .1 * k))
        clouds.write_text("\n".join(names) + "\n")
        for name, arguments in (("formula", ["--implicit", "(x-t)^2+y^2+z^2-1", "--box=-2,-2,-2,4,2,2", "--h", ".12", "--t", "0:0.7:1.4"]),
                                ("clouds", ["--clouds", str(clouds), "--h", ".12"])):
            with self.subTest(name):
                one, all_ = self.folder / f"{name}_one", self.folder / f"{name}_all"
                a, b = run([UMTET], one, arguments, "evolve"), of_ranks(all_, arguments, "evolve")
                self.assertEqual((a.returncode, b.returncode), (0, 0), a.stderr + b.stderr)
                self.assertEqual(len(list(all_.glob("step_*.vtu"))), 3)
                self.assertEqual(files_of(one), files_of(all_))
                for file in ("step_0000.vtu", "step_0001.vtu", "step_0002.vtu", "series.pvd"):
                    self.assertTrue((one / file).read_bytes() == (all_ / file).read_bytes(), file)
                rows = [[line.split(",") for line in (folder / "quality.csv").read_text().splitlines()] for folder in (one, all_)]
                timed = {k for k, title in enumerate(rows[0][0]) if "seconds" in title}
                for x, y in zip(*rows):
                    self.assertEqual([v for k, v in enumerate(x) if k not in timed], [v for k, v in enumerate(y) if k not in timed])

    def test_makes_the_files_of_one_process_of_a_grid(self):
        grid = self.folder / "ball.nrrd"
        write_grid(grid, 40, lambda x, y, z: math.sqrt(x * x + y * y + z * z) - 1)
        self.compare(["--level-set", str(grid), "--h", ".09"])

    def test_makes_the_files_of_one_process_of_a_cloud(self):
        self.compare([str(CLOUDS / "duck.ply")], "run")
        self.compare([str(CLOUDS / "duck.ply"), "--tets", "20000"], "run")

    def peaks(self, arguments):
        """@return of each rank, MB"""
        made = subprocess.run([MPIEXEC, "-n", N, "--oversubscribe", sys.executable, "-c", PEAK, str(self.folder / "peak"),
                               UMTET_MPI, *arguments], capture_output=True, text=True, timeout=300)
        self.assertEqual(made.returncode, 0, made.stderr)
        return [int((self.folder / f"peak{rank}").read_text()) / 1e3 for rank in range(int(N))]

    def test_no_rank_holds_much_more_than_the_others(self):
        if N != "4":
            self.skipTest("four ranks show it")
        cloud = self.folder / "ball.ply"
        write_cloud(cloud, ball(100000, (0, 0, 0), 1))
        idle = max(self.peaks(["--version"]))
        first, *others = self.peaks(["run", str(cloud), "--set", "cloud.merge=false", "--h", ".03", "--no-report", "--threads",
                                     "1", "-o", str(self.folder / "case")])
        self.assertLess(first - idle, 1.4 * (max(others) - idle), (idle, first, others))

    def test_psi_is_sent_again_where_the_next_h_shows_more_of_it(self):
        cloud = self.folder / "balls.ply"
        centres = [[.8 * x, .8 * y, .8 * z] for x in (-1, 0, 1) for y in (-1, 0, 1) for z in (-1, 0, 1)]
        write_cloud(cloud, [p for c in centres for p in ball(300, c, .054)])
        said = self.compare([str(cloud), "--tets", "17000", "--background", "a15", "--set", "reconstruct.spacing=.0161"], "run")
        hs = [float(h) for h in re.findall(r"h = ([\d.]+) makes .* trying", said)]
        nexts = [float(h) for h in re.findall(r"trying ([\d.]+)", said)]
        self.assertTrue(.7 * hs[0] > .0161 > .7 * nexts[0], said)

    def test_fits_bands_as_one_process_does(self):
        one, all_ = self.folder / "one", self.folder / "all"
        cloud = self.folder / "ball.ply"
        write_cloud(cloud, ball(12000, (0, 0, 0), 1))
        arguments = [str(cloud), "--set", "reconstruct.spacing=.02"]
        self.assertEqual(run([UMTET], one, arguments, "reconstruct").returncode, 0)
        self.assertEqual(of_ranks(all_, arguments, "reconstruct").returncode, 0)
        fits = [json.loads((case / "2-level-set/record.json").read_text())["numbers"] for case in (one, all_)]
        self.assertEqual(fits[0], fits[1])
        self.assertGreater(len(fits[0]["bands"]), 1)
        name = "2-level-set/level_set.vti"
        self.assertTrue((one / name).read_bytes() == (all_ / name).read_bytes())

    def test_makes_the_files_of_one_process_of_a_cloud_with_fields_far_from_the_origin(self):
        cloud = self.folder / "far.ply"
        write_cloud(cloud, ball(1500, (5e6, 0, -3e6), 1), fields=True)
        self.assertIn("rgb, heat", self.compare([str(cloud), "--h", ".15"], "run"))

    def test_leaves_out_what_one_process_leaves_out(self):
        cloud = self.folder / "two.ply"
        write_cloud(cloud, [*ball(2000, (0, 0, 0), 1), *ball(9, (1.9, 0, 0), .4)])
        self.assertIn("left out a piece", self.compare([str(cloud), "--keep-all", "--h", ".12"], "run"))

    def test_rank_0_makes_what_follows_the_body(self):
        cloud = self.folder / "dumbbell.ply"
        write_cloud(cloud, dumbbell())
        said = self.compare([str(cloud)], "run", ["mesh: one process makes this mesh: its background is no lattice"])
        self.assertIn("mesh: graded, with edges of at least", said)
        case, arguments = self.folder / "case", [str(cloud), "--export", "pvtu"]
        of_ranks(case, arguments, "run")
        again = of_ranks(case, arguments, "run")
        self.assertIn("nothing to do", again.stderr)
        self.assertTrue((case / "4-export/mesh.pvtu").exists())

    def test_meshes_the_fit_of_a_case(self):
        case = self.folder / "case"
        self.assertEqual(run([UMTET], case, [str(CLOUDS / "duck.ply"), "--h", ".08"], "run").returncode, 0)
        one = self.folder / "one"
        shutil.copytree(case, one)
        for command, folder in (([UMTET], one), ([MPIEXEC, "-n", N, "--oversubscribe", UMTET_MPI], case)):
            again = subprocess.run([*command, "mesh", str(folder), "--h", ".1", "--progress", "none"],
                                   capture_output=True, text=True, timeout=300)
            self.assertEqual(again.returncode, 0, again.stderr)
        for name in ("omega_h.vtu", "projected.vtu", "mesh.vtu", "quality.csv"):
            self.assertTrue((case / "3-mesh" / name).read_bytes() == (one / "3-mesh" / name).read_bytes(), name)

    def test_says_what_one_process_says_where_there_is_none(self):
        for arguments in (["--implicit", "x^2+y^2+z^2-1", "--box=-.9,-.9,-.9,.9,.9,.9", "--h", ".1"],
                          ["--implicit", "x^2+y^2+z^2+1", "--box=-.9,-.9,-.9,.9,.9,.9", "--h", ".1"],
                          ["--implicit", "x^2+", "--box=-1,-1,-1,1,1,1"],
                          ["--implicit", "x^2+y^2+z^2-1"],
                          ["--implicit", "x", "--hh", "3"]):
            with self.subTest(arguments):
                a, b = run([UMTET], self.folder / "one", arguments), of_ranks(self.folder / "all", arguments)
                self.assertNotEqual(a.returncode, 0)
                self.assertEqual(a.returncode, b.returncode, b.stderr)
                self.assertEqual(words(a.stderr, self.folder / "one"), words(b.stderr, self.folder / "all"))

    def test_repeats_nothing_that_is_done(self):
        arguments = CALLS["torus"]
        of_ranks(self.folder / "case", arguments)
        again = of_ranks(self.folder / "case", arguments)
        self.assertEqual(again.returncode, 0)
        self.assertIn("nothing to do", again.stderr)

    def test_exports_what_each_rank_has(self):
        import meshio  # beside numpy, of Debian's python3
        import numpy
        one, all_ = self.folder / "one", self.folder / "all"
        arguments = CALLS["two pieces, by tets"] + ["--export", "pvtu,xdmf,pmsh"]
        self.assertEqual(run([UMTET], one, arguments).returncode, 0)
        self.assertEqual(of_ranks(all_, arguments).returncode, 0)
        whole = meshio.read(one / "4-export/mesh_0.vtu")
        pieces = [meshio.read(f) for f in sorted((all_ / "4-export").glob("mesh_[0-9]*.vtu"))]
        self.assertEqual((all_ / "4-export/mesh.pvtu").read_text().count("<Piece "), len(pieces))
        numbers = numpy.concatenate([p.cell_data["global_tet"][0] for p in pieces])
        self.assertEqual(sorted(numbers), list(range(len(whole.cells[0].data))))
        for piece in pieces:
            vertex, tet = piece.point_data["global_vertex"], piece.cell_data["global_tet"][0]
            self.assertTrue((piece.points == whole.points[vertex]).all())
            self.assertTrue((vertex[piece.cells[0].data] == whole.cells[0].data[tet]).all())
            for name in ("background_vertex", "boundary", "boundary_1", "boundary_2"):
                self.assertTrue((piece.point_data[name] == whole.point_data[name][vertex]).all(), name)
        for name in ("mesh.xdmf", "mesh_boundary.xdmf"):
            self.assertEqual((one / "4-export" / name).read_text(), (all_ / "4-export" / name).read_text())
        again = of_ranks(all_, CALLS["two pieces, by tets"] + ["--export", "pvtu"])
        self.assertIn("mesh: made again", again.stderr)
        self.assertEqual([f.name for f in sorted((all_ / "4-export").glob("mesh_[0-9]*.vtu"))],
                         [f"mesh_{r}.vtu" for r in range(int(N))])
        self.same_arrays(one / "4-export/mesh.h5", all_ / "4-export/mesh.h5")  # skips the rest without h5py

    def pieces_of(self, whole, folder):
        """All pieces of a .pvtu have the arrays of the whole mesh."""
        import numpy
        pieces = [self.read(f) for f in sorted(folder.glob("mesh_[0-9]*.vtu"))]
        self.assertEqual(sum(len(p.cells[0].data) for p in pieces), len(whole.cells[0].data))
        for piece in pieces:
            vertex, tet = piece.point_data["global_vertex"], piece.cell_data["global_tet"][0]
            self.assertTrue((piece.points == whole.points[vertex]).all())
            self.assertTrue((vertex[piece.cells[0].data] == whole.cells[0].data[tet]).all())
            self.assertEqual(set(piece.point_data), set(whole.point_data))
            for name in set(piece.point_data) - {"owner", "global_vertex"}:
                numpy.testing.assert_array_equal(piece.point_data[name], whole.point_data[name][vertex], name)  # NaN is NaN
        return pieces

    def read(self, file):
        import meshio  # beside numpy, of Debian's python3
        return meshio.read(file)

    def test_pieces_of_a_scan_have_its_labels_and_fields(self):
        cloud = self.folder / "labels.ply"
        write_cloud(cloud, ball(2500, (0, 0, 0), 1), fields=True, label=lambda p: 1 if p[2] > .3 else 7)
        for order, formats in (("1", "pvtu,pmsh"), ("2", "pvtu")):
            with self.subTest(order=order):
                one, all_ = self.folder / f"one_{order}", self.folder / f"all_{order}"
                arguments = [str(cloud), "--h", ".12", "--order", order, "--label-names", "7=feet", "--export", formats]
                self.assertEqual(run([UMTET], one, arguments, "run").returncode, 0)
                made = of_ranks(all_, arguments, "run")
                self.assertEqual(made.returncode, 0, made.stderr)
                whole = self.read(one / "4-export/mesh_0.vtu")
                self.assertTrue({"feet", "patch_1", "scan_heat", "scan_rgb"} <= set(whole.point_data), set(whole.point_data))
                self.pieces_of(whole, all_ / "4-export")
                if "pmsh" in formats:
                    self.same_parts(one / "4-export", all_ / "4-export", whole)

    def same_parts(self, one, all_, whole):
        """Parts for Gmsh of a scan have its labels and fields; whole: the mesh with both."""
        import numpy
        names = [(folder / "mesh_part_1.msh").read_bytes().split(b"$EndPhysicalNames")[0] for folder in (one, all_)]
        self.assertEqual(names[0], names[1])
        parts = sorted(all_.glob("mesh_part_*.msh"))
        self.assertEqual(len(parts), int(N))
        self.assertEqual(list(map(set, map(node_data, parts))), int(N) * [{"scan_heat", "scan_rgb"}])
        for name in ("scan_heat", "scan_rgb"):
            known = set()
            for k, part in enumerate(parts, 1):
                head, tags, values = node_data(part)[name]
                self.assertEqual((head[0], head[3:]), (0, [k]))
                numpy.testing.assert_array_equal(values.squeeze(), whole.point_data[name][tags - 1], name)
                known.update(tags.tolist())
            self.assertEqual(known, set(range(1, len(whole.points) + 1)))
            self.assertTrue(numpy.isfinite(whole.point_data[name]).any())
        if N == "1":
            self.assertTrue(parts[0].read_bytes() == (one / "mesh_part_1.msh").read_bytes())

    def test_gmsh_joins_fields_of_parts(self):
        if not shutil.which("gmsh"):
            self.skipTest("no gmsh")
        cloud = self.folder / "fields.ply"
        write_cloud(cloud, ball(1500, (0, 0, 0), 1), fields=True)
        arguments = [str(cloud), "--h", ".2", "--background", "a15", "--export", "pmsh,msh"]
        self.assertEqual(of_ranks(self.folder / "case", arguments, "run").returncode, 0)
        folder = self.folder / "case/4-export"
        said = []
        for files in (sorted(folder.glob("mesh_part_*.msh")), [folder / "mesh.msh"]):
            (folder / "views.geo").write_text("".join(f'Merge "{f}";\n' for f in files) + """
For v In {0 : PostProcessing.NbViews - 1}
  Printf("of %g views one from %g to %g", PostProcessing.NbViews, View[v].Min, View[v].Max);
EndFor
""")
            made = subprocess.run(["gmsh", "-0", "-parse_and_exit", str(folder / "views.geo")], capture_output=True, text=True,
                                  timeout=300)
            said.append(re.findall("of .* views one .*", made.stdout))
        self.assertEqual(len(said[1]), 2, made.stdout)  # scan_heat, scan_rgb
        self.assertEqual(said[0], said[1])

    def test_exports_a_case_in_pieces(self):
        case, arguments = self.folder / "case", CALLS["two pieces, by tets"] + ["--export", "pvtu"]
        self.assertEqual(run([UMTET], case, arguments).returncode, 0)
        whole = self.read(case / "4-export/mesh_0.vtu")
        before = (case / "3-mesh/mesh.vtu").read_bytes()
        made = subprocess.run([MPIEXEC, "-n", N, "--oversubscribe", UMTET_MPI, "export", str(case), "--format", "pvtu,stl"],
                              capture_output=True, text=True, timeout=300)
        self.assertEqual(made.returncode, 0, made.stderr)
        self.assertEqual(len(self.pieces_of(whole, case / "4-export")), int(N))
        self.assertTrue((case / "4-export/mesh.stl").exists())
        self.assertTrue(before == (case / "3-mesh/mesh.vtu").read_bytes())

    def same_arrays(self, a, b):
        try:
            import h5py
        except ImportError:
            self.skipTest("no python3-h5py")
        with h5py.File(a) as one, h5py.File(b) as other:
            names = []
            one.visititems(lambda name, item: names.append(name) if hasattr(item, "shape") else None)
            self.assertIn("point_data/boundary_2", names)
            for name in names:
                self.assertEqual((one[name].dtype, one[name].shape), (other[name].dtype, other[name].shape))
                self.assertTrue((one[name][...] == other[name][...]).all(), name)

    def test_gmsh_reads_the_parts_as_one_mesh(self):
        if not shutil.which("gmsh"):
            self.skipTest("no gmsh")
        made = of_ranks(self.folder / "case", CALLS["torus"] + ["--export", "pmsh,msh"])
        self.assertEqual(made.returncode, 0, made.stderr)
        folder = self.folder / "case/4-export"
        script = "".join(f'Merge "{f}";\n' for f in sorted(folder.glob("mesh_part_*.msh")))
        (folder / "all.geo").write_text(script + 'Mesh.SaveAll = 1;\nMesh.MshFileVersion = 4.1;\nSave "all.msh";\n')
        # Gmsh 4.8 may crash at its end when it has merged files with ghost elements, its own, too: all.msh is there then.
        subprocess.run(["gmsh", "-0", "-parse_and_exit", str(folder / "all.geo")], capture_output=True, timeout=300)

        def counts(file):
            lines = file.read_bytes().split(b"\n")
            return [lines[lines.index(b"$" + name) + 1].split() for name in (b"Nodes", b"Elements")]

        subprocess.run(["gmsh", "-0", str(folder / "mesh.msh"), "-format", "msh4", "-o", str(folder / "one.msh")], check=True,
                       capture_output=True, timeout=300)
        nodes, elements = zip(counts(folder / "all.msh"), counts(folder / "one.msh"))
        self.assertEqual(elements[0][1:], elements[1][1:])  # how many, and the least and the greatest number
        self.assertEqual(nodes[0][2:], nodes[1][2:])  # Gmsh keeps a node of several files as often, of its own files, too
        parts = (folder / "all.msh").read_text().split("$PartitionedEntities\n")[1].split()[0]
        self.assertEqual(int(parts), len(list(folder.glob("mesh_part_*.msh"))))

    def test_a_rank_that_cannot_write_ends_all_with_one_reason(self):
        # 10 MB: MPI has files of its own.
        made = with_a_rank("ulimit -f 20000", self.folder / "case", CALLS["torus"][:-1] + [".03"])
        self.assertEqual(made.returncode, 7, made.stderr)
        self.assertEqual(made.stderr.count("umtet: "), 1, made.stderr)
        self.assertIn("omega_h.vtu", made.stderr)
        self.assertLessEqual(files_of(self.folder / "case"), {".lock", "case.toml"})

    def test_a_rank_that_is_killed_ends_all_and_the_next_run_is_whole(self):
        case, arguments = self.folder / "case", CALLS["torus"][:-1] + [".03"]
        start = time.monotonic()
        made = with_a_rank("( sleep .7; kill -9 $$ ) &", case, arguments)
        self.assertLess(time.monotonic() - start, 10)
        self.assertNotEqual(made.returncode, 0)
        self.assertNotIn("3-mesh/record.json", files_of(case))
        self.assertEqual(of_ranks(case, arguments).returncode, 0)
        self.assertEqual(run([UMTET], self.folder / "one", arguments).returncode, 0)
        for name in ("omega_h.vtu", "mesh.vtu"):
            self.assertTrue((case / "3-mesh" / name).read_bytes() == (self.folder / "one/3-mesh" / name).read_bytes())
        self.assertFalse([f for f in files_of(case) if ".tmp" in f])

    def test_refuses_what_is_for_one_process(self):
        ball = ["--implicit", "x^2+y^2+z^2-1", "--box=-1.4,-1.4,-1.4,1.4,1.4,1.4", "--h", ".2"]
        for more in (["--mode", "paper"], ["--box-walls", "--complement"], ["--size", ".2+.01*x"]):
            with self.subTest(more):
                made = of_ranks(self.folder / "case", ball + more)
                self.assertEqual(made.returncode, 0 if N == "1" else 2, made.stderr)


if __name__ == "__main__":
    os.environ.setdefault("OMPI_ALLOW_RUN_AS_ROOT", "1")
    os.environ.setdefault("OMPI_ALLOW_RUN_AS_ROOT_CONFIRM", "1")
    unittest.main(argv=sys.argv[:1])
