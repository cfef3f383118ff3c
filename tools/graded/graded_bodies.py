#!/usr/bin/python3
"""Graded meshes of bodies given by formulas, beside TetGen, Gmsh and CGAL: one row of Markdown for each mesh.

usage: graded_bodies.py UMTET [--cgal=PROGRAM] [--folder=FOLDER] [--positions=N] [BODY ...]

TetGen (`tetgen -pq1.4/15`) fills the boundary of our mesh, Gmsh and CGAL (PROGRAM: that of cgal_mesh_3.cpp) mesh the
same body with the same size field. Without BODY all are meshed. In FOLDER the meshes are left to be looked at. With
--positions there is one row for each body instead, with the ranges of N meshes of ours, each with the body elsewhere
in the octree. Needs python3-numpy and python3-meshio, and of tetgen and gmsh what is to be compared with.
"""
import contextlib
import io
import pathlib
import shutil
import sys
import tempfile
from typing import NamedTuple

import meshio
import numpy as np

sys.path.insert(0, str(pathlib.Path(__file__).parent.parent / "scans"))
from case import timed  # noqa: E402


class Body(NamedTuple):
    psi: str
    box: str
    flags: list  # of umtet
    geo: str = ""  # Gmsh's OpenCASCADE commands
    size: tuple = ()  # finest, growth a length, and the fine point
    cgal: str = ""  # what cgal_mesh_3 calls it


def fine_at(point, finest, growth):
    """A size field as a formula; .0001 keeps its root smooth."""
    squares = "+".join(f"({axis}-({x}))^2" for axis, x in zip("xyz", point))
    return f"{finest}+{growth}*sqrt({squares}+.0001)"


def graded_at(name, psi, box, largest, geo, size):
    return Body(psi, box, ["--h", str(largest), "--size", fine_at(size[2], *size[:2])], geo, size, name)


TIMEOUT = 120  # seconds, of those we compare with: exit 124

SPHERE = ("x^2+y^2+z^2-1", "-1.2,-1.2,-1.2,1.2,1.2,1.2")
SPHERE_GEO = "Sphere(1) = {0, 0, 0, 1};"
TORUS = ("(x^2+y^2+z^2+.84)^2-4*(x^2+y^2)", "-1.6,-1.6,-.6,1.6,1.6,.6")
BALLS = "exp(-((x-.8)^2+y^2+z^2-.16)/.016)+exp(-((x+.8)^2+y^2+z^2-.16)/.016)"
ROD = "exp(-((y^2+z^2-.0036)/.12+.03*(x/.8)^20)/.02)"
EQ_9 = ("sqrt((x-2)^2+y^2+z^2+.2)*sqrt((x+2)^2+y^2+z^2+.2)*sqrt(x^2+(y-2)^2+z^2+.2)*sqrt(x^2+(y+2)^2+z^2+.2)-17")
BODIES = {
    "sphere, 4 x": graded_at("sphere", *SPHERE, .1, SPHERE_GEO, (.025, .05, (0, 0, 1))),
    "sphere, 8 x": graded_at("sphere", *SPHERE, .1, SPHERE_GEO, (.0125, .0583, (0, 0, 1))),
    "sphere, 16 x": graded_at("sphere", *SPHERE, .1, SPHERE_GEO, (.00625, .0625, (0, 0, 1))),
    "torus, 4 x": graded_at("torus", *TORUS, .09, "Torus(1) = {0, 0, 0, 1, .4};", (.02, .025, (-1.4, 0, 0))),
    "ellipsoid 1:1:.2, 8 x at the rim":
        graded_at("ellipsoid", "x^2+y^2+25*z^2-1", "-1.2,-1.2,-.3,1.2,1.2,.3", .1,
                  SPHERE_GEO + " Dilate {{0, 0, 0}, {1, 1, .2}} { Volume{1}; }", (.0125, .0437, (1, 0, 0))),
    "ellipsoid 1:1:.2 by thickness and curvature":
        Body("x^2+y^2+25*z^2-1", "-1.2,-1.2,-.3,1.2,1.2,.3", []),
    "ellipsoid 1:1:.1 by thickness and curvature":
        Body("x^2+y^2+100*z^2-1", "-1.2,-1.2,-.2,1.2,1.2,.2", []),
    "dumbbell with a rod of .06": Body(f"-.02*log({BALLS}+{ROD})", "-1.4,-.6,-.6,1.4,.6,.6", []),
    "eq. (9) by curvature": Body(EQ_9, "-3,-3,-3,3,3,3", ["--max-turn", "25"]),
    "sphere, coarse inside": Body(*SPHERE, ["--grade-inside", "--h", ".03"]),
}

GEO = """SetFactory("OpenCASCADE");
{geo}
Field[1] = MathEval;
Field[1].F = "{size}";
Background Field = 1;
Mesh.MeshSizeExtendFromBoundary = 0;
Mesh.MeshSizeFromPoints = 0;
"""


def tets_of(file):
    with contextlib.redirect_stdout(io.StringIO()):  # meshio prints an empty line
        mesh = meshio.read(file)
    cells = np.concatenate([c.data for c in mesh.cells if c.type == "tetra"])
    return np.asarray(mesh.points, float), cells


def measures(points, tets):
    """Mean ratios, and the least and the greatest dihedral angle in degrees."""
    p = points[tets]
    edges = sum(((p[:, i] - p[:, j]) ** 2).sum(1) for i in range(4) for j in range(i))
    volume = np.abs(np.einsum("ni,ni->n", p[:, 1] - p[:, 0], np.cross(p[:, 2] - p[:, 0], p[:, 3] - p[:, 0]))) / 6
    q = 12 * np.cbrt(9 * volume ** 2) / edges
    least, most = 180, 0
    for i, j, k, l in ((0, 1, 2, 3), (0, 2, 1, 3), (0, 3, 1, 2), (1, 2, 0, 3), (1, 3, 0, 2), (2, 3, 0, 1)):
        axis = p[:, j] - p[:, i]
        a, b = np.cross(axis, p[:, k] - p[:, i]), np.cross(axis, p[:, l] - p[:, i])
        angle = np.degrees(np.arccos(np.clip((a * b).sum(1) / np.linalg.norm(a, axis=1) / np.linalg.norm(b, axis=1), -1, 1)))
        least, most = min(least, angle.min()), max(most, angle.max())
    return q, least, most


def row(name, mesher, done, file):
    if not pathlib.Path(file).exists():
        return f"| {name} | {mesher} | - | - | - | - | {done.cpu:.1f} | {done.code} |"
    points, tets = tets_of(file)
    q, least, most = measures(points, tets)
    return (f"| {name} | {mesher} | {len(tets):,} | {q.min():.3f} | {np.quantile(q, .01):.3f} | {least:.1f} to {most:.1f} "
            f"| {done.cpu:.1f} | {done.code} |")


def boundary_faces(tets):
    faces = np.concatenate([tets[:, [1, 2, 3]], tets[:, [0, 3, 2]], tets[:, [0, 1, 3]], tets[:, [0, 2, 1]]])
    _, first, count = np.unique(np.sort(faces, axis=1), axis=0, return_index=True, return_counts=True)
    return faces[first[count == 1]]


def tetgen(ours, folder):
    """Into the folder; the boundary of our mesh is its input."""
    points, tets = tets_of(ours)
    used, faces = np.unique(boundary_faces(tets), return_inverse=True)
    with open(folder / "body.smesh", "w", encoding="utf8") as f:
        print(len(used), "3 0 0", file=f)
        for i, x in enumerate(points[used]):
            print(i, *x, file=f)
        faces = faces.reshape(-1, 3)
        print(len(faces), "0", file=f)
        for a, b, c in faces:
            print("3", a, b, c, file=f)
        print("0\n0", file=f)
    done = timed(["tetgen", "-pq1.4/15", "-gQ", folder / "body.smesh"], TIMEOUT)
    if (folder / "body.1.mesh").exists():
        (folder / "body.1.mesh").rename(folder / "tetgen.mesh")
    return done


def gmsh(body, folder):
    (folder / "body.geo").write_text(GEO.format(geo=body.geo, size=fine_at(body.size[2], *body.size[:2])), encoding="utf8")
    return timed(["gmsh", "-3", "-nt", "1", "-v", "0", "-format", "msh41", "-o", folder / "gmsh.msh", folder / "body.geo"], TIMEOUT)


def meshed(umtet, body, box, folder):
    done = timed([umtet, "mesh", "--implicit=" + body.psi, "--box=" + box, "--background", "graded", *body.flags,
                  "--no-report", "--progress", "none", "--threads", "1", "-o", folder / "umtet"])
    return done, folder / "umtet" / "3-mesh" / "mesh.vtu"


def moved(box, k):
    """A box that is a little longer: its centre is that of the octree. 0: as it is."""
    corners = [float(x) for x in box.split(",")]
    for axis, ratio in enumerate((.618, .382, .236)):
        corners[3 + axis] += .03 * (k * ratio % 1)
    return ",".join(f"{x:g}" for x in corners)


def ranges(umtet, name, n, folder):
    """The row of a body in n positions."""
    found = []
    for k in range(n):
        done, file = meshed(umtet, BODIES[name], moved(BODIES[name].box, k), folder)
        points, tets = tets_of(file)
        q, least, most = measures(points, tets)
        found.append((len(tets), q.min(), np.quantile(q, .01), least, most, done.cpu, done.code))
        shutil.rmtree(folder / "umtet")
    low, high = np.min(found, axis=0), np.max(found, axis=0)
    return (f"| {name} | {low[0]:,.0f} to {high[0]:,.0f} | {low[1]:.3f} to {high[1]:.3f} | {low[2]:.3f} to {high[2]:.3f} "
            f"| {low[3]:.1f} to {high[4]:.1f} | {low[5]:.1f} to {high[5]:.1f} | {high[6]:.0f} |")


def main():
    options = dict(a[2:].split("=", 1) for a in sys.argv[1:] if a.startswith("--"))
    umtet, *names = [a for a in sys.argv[1:] if not a.startswith("--")]
    n_positions = int(options.get("positions", 0))
    columns = ["body", *([] if n_positions else ["mesher"]), "tets", "min Q", "1 % Q", "dihedral angles", "CPU s", "exit"]
    print("| " + " | ".join(columns) + " |\n" + "|---" * len(columns) + "|", flush=True)
    with tempfile.TemporaryDirectory() as temporary:
        for name in names or BODIES:
            body = BODIES[name]
            folder = pathlib.Path(options.get("folder", temporary)) / name.replace(" ", "_").replace(",", "")
            shutil.rmtree(folder, ignore_errors=True)
            folder.mkdir(parents=True)
            if n_positions:
                print(ranges(umtet, name, n_positions, folder), flush=True)
                continue
            done, ours = meshed(umtet, body, body.box, folder)
            print(row(name, "umtet", done, ours), flush=True)
            if ours.exists() and shutil.which("tetgen"):
                print(row(name, "TetGen", tetgen(ours, folder), folder / "tetgen.mesh"), flush=True)
            if body.geo and shutil.which("gmsh"):
                print(row(name, "Gmsh", gmsh(body, folder), folder / "gmsh.msh"), flush=True)
            if body.cgal and "cgal" in options:
                done = timed([options["cgal"], body.cgal, str(body.size[0]), str(body.size[1]), folder / "cgal.mesh"], TIMEOUT)
                print(row(name, "CGAL", done, folder / "cgal.mesh"), flush=True)


if __name__ == "__main__":
    main()
