"""The examples for solvers: the solution of four processes is that of one.

usage: solvers_test.py MPIEXEC SOURCE [POISSON_PLEX]
"""
import array
import importlib.util
import os
import pathlib
import re
import subprocess
import sys
import tempfile
import unittest

MPIEXEC, SOURCE, PLEX = sys.argv[1], sys.argv[2], (sys.argv[3:] or [""])[0]


class Solvers(unittest.TestCase):
    def check(self, program, read, suffix, more=(), error=.01):
        """more: further arguments. error: at most, of elements of this length; u is at most 1/6."""
        with tempfile.TemporaryDirectory() as folder:
            solutions = []
            for n in (1, 4):
                file = pathlib.Path(folder, f"{n}{suffix}")
                made = subprocess.run([MPIEXEC, "-n", str(n), "--oversubscribe", *program, ".25", str(file), *more],
                                      capture_output=True, text=True, timeout=300)
                self.assertEqual(made.returncode, 0, made.stderr)
                self.assertLess(float(re.search(r"largest error ([-+.e0-9]+)", made.stdout)[1]), error)
                solutions.append(read(file))
            one, four = solutions
            self.assertGreater(len(one), 500)
            self.assertEqual(len(one), len(four))
            self.assertGreater(max(one), .15)
            self.assertLess(max(abs(a - b) for a, b in zip(one, four)), 1e-10)

    def test_plex(self):
        if not PLEX:
            self.skipTest("no PETSc")

        def doubles(file):
            return array.array("d", file.read_bytes())

        self.check([PLEX], doubles, ".bin")

    def test_dolfinx(self):
        for name in ("dolfinx", "mpi4py", "umtet", "umtet._distributed"):
            if importlib.util.find_spec(name) is None:
                self.skipTest(f"no {name}")

        def numbers(file):
            import numpy
            return numpy.load(file).tolist()

        program = ["/usr/bin/python3", SOURCE + "/examples/python/poisson_dolfinx.py"]
        self.check(program, numbers, ".npy")
        self.check(program, numbers, ".npy", more=["2"], error=2e-4)


if __name__ == "__main__":
    os.environ.setdefault("OMPI_ALLOW_RUN_AS_ROOT", "1")
    os.environ.setdefault("OMPI_ALLOW_RUN_AS_ROOT_CONFIRM", "1")
    unittest.main(argv=sys.argv[:1])
