"""Heat through two concentric shells of different conductivities, by CalculiX and by dolfinx, on exported regions.

The temperature is 1 on the sphere of radius RADII[0] and 0 on that of RADII[2]; the shells meet at RADII[1]. The flux is
4 pi / ((1/r0 - 1/r1) / k1 + (1/r1 - 1/r2) / k2). Each part skips without its solver.
"""
import importlib.util
import math
import os
import pathlib
import re
import shutil
import subprocess
import tempfile
import unittest

PROGRAM = os.environ["UMTET_PROGRAM"]
RADII = (.4, .7, 1.)
CONDUCTIVITY = {"mantle": 10., "coat": 1.}
FLUX = 4 * math.pi / ((1 / RADII[0] - 1 / RADII[1]) / CONDUCTIVITY["mantle"]
                      + (1 / RADII[1] - 1 / RADII[2]) / CONDUCTIVITY["coat"])

# The tets of the hole have the temperature of its boundary, and no heat flows in them.
CALCULIX = """*INCLUDE, INPUT=shells/4-export/mesh.inp
*MATERIAL, NAME=good
*CONDUCTIVITY
{mantle}
*MATERIAL, NAME=poor
*CONDUCTIVITY
{coat}
*SOLID SECTION, ELSET=mantle, MATERIAL=good
*SOLID SECTION, ELSET=coat, MATERIAL=poor
*SOLID SECTION, ELSET=hole, MATERIAL=good
*STEP
*HEAT TRANSFER, STEADY STATE
*BOUNDARY
mantle|hole, 11, 11, 1.
coat|outside, 11, 11, 0.
*NODE PRINT, NSET=coat|outside, TOTALS=ONLY
RFL
*END STEP
"""

DOLFINX = """
import sys
import numpy as np
import ufl
from dolfinx import fem, io, mesh
from dolfinx.fem.petsc import LinearProblem
from mpi4py import MPI

with io.XDMFFile(MPI.COMM_WORLD, sys.argv[1] + "/mesh.xdmf", "r") as file:
    domain = file.read_mesh(name="mesh")
    regions = file.read_meshtags(domain, name="mesh")
domain.topology.create_connectivity(2, 3)
with io.XDMFFile(MPI.COMM_WORLD, sys.argv[1] + "/mesh_boundary.xdmf", "r") as file:
    patches = file.read_meshtags(domain, name="boundary")
region, patch, conductivity = (eval(word) for word in sys.argv[2:5])
V = fem.FunctionSpace(domain, ("Lagrange", 1))
k = fem.Function(fem.FunctionSpace(domain, ("DG", 0)))
for name, number in region.items():
    k.x.array[regions.indices[regions.values == number]] = conductivity[name]
u, v = ufl.TrialFunction(V), ufl.TestFunction(V)
fixed = []
for name, value in (("mantle|hole", 1.), ("coat|outside", 0.)):
    dofs = fem.locate_dofs_topological(V, 2, patches.indices[patches.values == patch[name]])
    assert len(dofs) > 0, name
    fixed.append(fem.dirichletbc(value, dofs, V))
T = LinearProblem(k * ufl.inner(ufl.grad(u), ufl.grad(v)) * ufl.dx, fem.Constant(domain, 0.) * v * ufl.dx, fixed,
                  petsc_options={"ksp_type": "cg", "pc_type": "jacobi", "ksp_rtol": 1e-10}).solve()
# The flux times the difference of temperatures, which is 1, is the energy.
print("flux", fem.assemble_scalar(fem.form(k * ufl.inner(ufl.grad(T), ufl.grad(T)) * ufl.dx)))
"""


class TwoConductivities(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.folder = tempfile.TemporaryDirectory()
        spheres = [f"{name}=x^2+y^2+z^2-{r * r!r}" for name, r in zip(("hole", "mantle", "coat"), RADII)]
        cls.call("regions", *reversed(spheres), "--no-outside", "--box=-1.3,-1.3,-1.3,1.3,1.3,1.3", "--h=.1", "-o",
                 "shells", "--export", "inp,xdmf")

    @classmethod
    def tearDownClass(cls):
        cls.folder.cleanup()

    @classmethod
    def call(cls, *words):
        made = subprocess.run([PROGRAM, *words], cwd=cls.folder.name, capture_output=True, text=True)
        if made.returncode != 0:
            raise RuntimeError(made.stdout + made.stderr)
        return made.stdout

    def run_in(self, *words):
        made = subprocess.run(words, cwd=self.folder.name, capture_output=True, text=True)
        self.assertEqual(made.returncode, 0, made.stdout + made.stderr)
        return made.stdout

    def names(self, kind, file):
        """Names and numbers of regions or patches in an .xdmf file."""
        text = pathlib.Path(self.folder.name, "shells/4-export", file).read_text()
        inside = re.search(f'Information Name="{kind}">(.*?)</Information>', text)[1]
        return {name: int(number) for name, number in re.findall(r'key="([^"]+)" dim="[23]">([0-9]+)<', inside)}

    def test_calculix(self):
        if not shutil.which("ccx"):
            self.skipTest("calculix-ccx is not installed")
        pathlib.Path(self.folder.name, "heat.inp").write_text(CALCULIX.format(**CONDUCTIVITY))
        said = self.run_in("ccx", "heat")
        self.assertIn("Job finished", said)
        self.assertNotIn("*ERROR", said)
        result = pathlib.Path(self.folder.name, "heat.dat").read_text()
        flux = abs(float(re.search(r"COAT\|OUTSIDE.*\n\n\s+([-+.E0-9]+)", result)[1]))
        print(f"CalculiX: flux {flux:.5f}, exact {FLUX:.5f}, error {flux / FLUX - 1:+.2%}")
        self.assertLess(abs(flux / FLUX - 1), .01)

    def test_dolfinx(self):
        for name in ("dolfinx", "mpi4py", "petsc4py"):
            if importlib.util.find_spec(name) is None:
                self.skipTest(f"no {name}")
        region, patch = self.names("regions", "mesh.xdmf"), self.names("patches", "mesh_boundary.xdmf")
        conductivity = {**CONDUCTIVITY, "hole": 1.}
        pathlib.Path(self.folder.name, "heat.py").write_text(DOLFINX)
        said = self.run_in("/usr/bin/python3", "heat.py", "shells/4-export", repr(region), repr(patch),
                           repr(conductivity))
        flux = float(re.search(r"flux ([-+.e0-9]+)", said)[1])
        print(f"dolfinx: flux {flux:.5f}, exact {FLUX:.5f}, error {flux / FLUX - 1:+.2%}")
        self.assertLess(abs(flux / FLUX - 1), .01)


if __name__ == "__main__":
    unittest.main()
