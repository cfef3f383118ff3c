"""`mpirun -n N umtet_mpi` against `umtet`: the same files, and the same words where there is no mesh.

usage: program_test.py UMTET UMTET_MPI MPIEXEC N
"""

import json
import os
import pathlib
import re
import shutil
import subprocess
import sys
import tempfile
import time
import unittest

UMTET, UMTET_MPI, MPIEXEC, N = sys.argv[1:5]
CALLS = {
    "torus": ["--implicit", "(sqrt(x^2+y^2)-1)^2+z^2-.16", "--box=-1.6,-1.6,-.6,1.6,1.6,.6", "--h", ".08"],
    "two pieces, by tets": ["--implicit", "((x-1.3)^2+y^2+z^2-1)*((x+1.3)^2+y^2+z^2-1)", "--box=-2.6,-1.3,-1.3,2.6,1.3,1.3",
                            "--tets", "30000"],
    "tries another h": ["--implicit", "x^4+y^4+z^4-1.2*(x^2+y^2+z^2)+.6", "--box=-1.5,-1.5,-1.5,1.5,1.5,1.5", "--h", ".2"],
    "z tiling": ["--implicit", "x^2+2*y^2+3*z^2-1", "--box=-1.4,-1.4,-1.4,1.4,1.4,1.4", "--background", "z", "--h", ".1"],
    "too thin": ["--implicit", "x^2+y^2+900*z^2-1", "--box=-1.4,-1.4,-.4,1.4,1.4,.4", "--h", ".15"],
}


def run(command, folder, arguments):
    return subprocess.run([*command, "mesh", *arguments, "-o", str(folder), "--progress", "none"], capture_output=True,
                          text=True, timeout=300)


def of_ranks(folder, arguments):
    return run([MPIEXEC, "-n", N, "--oversubscribe", UMTET_MPI], folder, arguments)


def with_a_rank(trouble, folder, arguments):
    """The last rank has trouble: a command of the shell that becomes the program."""
    script = f'if [ "$OMPI_COMM_WORLD_RANK" = {int(N) - 1} ]; then {trouble}; fi; exec "$@"'
    return run([MPIEXEC, "-n", N, "--oversubscribe", "sh", "-c", script, "sh", UMTET_MPI], folder, arguments)


def files_of(folder):
    return {f.relative_to(folder).as_posix() for f in folder.rglob("*") if f.is_file()}


def words(text, folder):
    """What a run says, without times and the words of mpirun."""
    text = text.replace(str(folder), "CASE").split("-----")[0]
    return [re.sub(r"[\d.]+ s$", "T s", line) for line in text.splitlines() if line.startswith(("umtet", "mesh", "  "))]


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
                one, all_ = self.folder / "one", self.folder / "all"
                a, b = run([UMTET], one, arguments), of_ranks(all_, arguments)
                self.assertEqual(a.returncode, b.returncode, b.stderr)
                self.assertEqual(words(a.stderr, one), words(b.stderr, all_))
                files = sorted(f.relative_to(one) for f in one.rglob("*") if f.is_file())
                self.assertEqual(files, sorted(f.relative_to(all_) for f in all_.rglob("*") if f.is_file()))
                self.assertIn(pathlib.Path("3-mesh/mesh.vtu"), files)
                for file in files:
                    if file.suffix in (".vtu", ".vtp", ".csv", ".toml"):
                        self.assertTrue((one / file).read_bytes() == (all_ / file).read_bytes(), file)
                self.assertEqual(without_run(one / "certificate.json"), without_run(all_ / "certificate.json"))
                shutil.rmtree(one)
                shutil.rmtree(all_)

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
        for more in (["--mode", "paper"], ["--order", "2"], ["--box-walls", "--complement"], ["--size", ".2+.01*x"]):
            with self.subTest(more):
                made = of_ranks(self.folder / "case", ball + more)
                self.assertEqual(made.returncode, 0 if N == "1" else 2, made.stderr)


if __name__ == "__main__":
    os.environ.setdefault("OMPI_ALLOW_RUN_AS_ROOT", "1")
    os.environ.setdefault("OMPI_ALLOW_RUN_AS_ROOT_CONFIRM", "1")
    unittest.main(argv=sys.argv[:1])
