#!/usr/bin/python3
"""Bodies with sharp edges, by formulas and by triangles: one row of Markdown for each body, or for each tool.

usage: edged_bodies.py UMTET [--positions=N] [--peers] [--cgal=PROGRAM] [--shared=FOLDER] [--folder=FOLDER] [BODY ...]

Each body is meshed in N random rotations with random offsets (default 1). A formula is rotated by substitution, and has
edges of 2/9 of half its side; triangles are rotated, and umtet chooses their sizes. A row has the worst of all positions,
and the median of the least Q. With --peers TetGen and Gmsh HXT mesh the same body, too, and with --cgal CGAL's Mesh_3
(PROGRAM: that of cgal_edges.cpp); their sizes are such that they make about as many tets. Their input is the triangles,
or, for a formula, the boundary of umtet's mesh, and for Gmsh and CGAL that of a finer mesh. --shared adds the parts of a folder of public files. The curves of
formulas are known here; those of triangles are edges that turn by more than 40 degrees. "missed" is the share of their
length that is farther than a fifth of an edge from all edges of the mesh at which its boundary turns by 25 degrees or
more. Without BODY all are meshed. In FOLDER the meshes are left to be looked at.

Needs python3-numpy, python3-scipy, python3-meshio, python3-vtk9, and of tetgen and gmsh what is to be compared with.
"""
import contextlib
import io
import pathlib
import re
import shutil
import sys
import tempfile
from typing import NamedTuple

import numpy as np
from scipy.spatial import cKDTree

HERE = pathlib.Path(__file__).resolve().parent
sys.path[:0] = [str(HERE.parent / "scans"), str(HERE.parent / "graded")]
import tet_mesh  # noqa: E402
import triangle_mesh  # noqa: E402
from case import TIMEOUT, certified, timed  # noqa: E402
from graded_bodies import boundary_faces, measures  # noqa: E402
from rotated import rotated_formula, rotations  # noqa: E402

H = 2 / 9  # of formulas; their sides are about 2
RADIUS = 2  # of a ball that contains each of them
SECONDS = 60  # of CPU, of those we compare with
SHARP, IS_EDGE = 40, 25  # degrees: of edges that have to be there, and of edges of a mesh that count
OFF = .2  # of an edge: a point of a curve that is farther from all edges is missed; chords of circles are up to .15 away
STEP = .05  # of an edge: between points of a curve that are looked at
ENOUGH = 1.2  # a number of tets that is off by this factor is near enough to be compared
FINER = 3  # edges of our mesh of a formula over those of the triangles that others make their own from


class Body(NamedTuple):
    formula: str = ""
    curves: tuple = ()  # of a formula: polylines, (n, 3) each
    triangles: tuple = ()  # vertices and faces


# Curves and triangles ---------------------------------------------------------------------------------------------

def arc(centre, u, v, begin=0., end=2 * np.pi, n=720):
    t = np.linspace(begin, end, n)[:, None]
    return np.asarray(centre, float) + np.cos(t) * np.asarray(u, float) + np.sin(t) * np.asarray(v, float)


def segments(*pairs):
    return [np.array(pair, float) for pair in pairs]


def prism_edges(polygon, low, high):
    ends = [[(*p, z) for p in polygon] for z in (low, high)]
    n = len(polygon)
    return segments(*[(ends[s][k], ends[s][(k + 1) % n]) for s in (0, 1) for k in range(n)],
                    *[(ends[0][k], ends[1][k]) for k in range(n)])


def extruded(points, faces, low, high):
    """A plane triangulation, counterclockwise, with its walls."""
    points, faces = np.asarray(points, float), np.asarray(faces, int)
    n = len(points)
    edges = np.concatenate([faces[:, [0, 1]], faces[:, [1, 2]], faces[:, [2, 0]]])
    twins = {tuple(e) for e in edges[:, ::-1]}
    rim = np.array([e for e in edges if tuple(e) not in twins])
    walls = np.concatenate([np.c_[rim, rim[:, 1] + n], np.c_[rim[:, 0], rim[:, 1] + n, rim[:, 0] + n]])
    x = np.concatenate([np.c_[points, np.full(n, float(z))] for z in (low, high)])
    return x, np.concatenate([faces[:, ::-1], faces + n, walls])


def revolved(profile, n):
    """A closed profile of radius and height, counterclockwise, around the z axis."""
    profile, m = np.asarray(profile, float), len(profile)
    angle = 2 * np.pi * np.arange(n) / n
    x = np.stack([np.outer(np.cos(angle), profile[:, 0]), np.outer(np.sin(angle), profile[:, 0]),
                  np.tile(profile[:, 1], (n, 1))], -1).reshape(-1, 3)
    k, j = (a.ravel() for a in np.meshgrid(np.arange(n), np.arange(m), indexing="ij"))
    a, b = k * m + j, k * m + (j + 1) % m
    c, d = ((k + 1) % n) * m + j, ((k + 1) % n) * m + (j + 1) % m
    return x, np.concatenate([np.c_[a, d, b], np.c_[a, c, d]])


def bracket():
    """An L of five unit squares, three of them with round holes, as thick as .5."""
    n = 4  # parts of the side of a square
    points, faces, at = [], [], {}

    def vertex(p):
        key = tuple(np.round(p, 9))
        if key not in at:
            at[key] = len(points)
            points.append(key)
        return at[key]

    for i, j, r in ((0, 0, .0), (1, 0, .25), (2, 0, .3), (0, 1, .0), (0, 2, .3)):
        corners = np.array([[-.5, -.5], [.5, -.5], [.5, .5], [-.5, .5]])
        centre = np.array([i + .5, j + .5])
        ring = [vertex(centre + corners[k] + s / n * (corners[(k + 1) % 4] - corners[k])) for k in range(4) for s in range(n)]
        size = 4 * n
        if r == 0:
            middle = vertex(centre)
            faces += [(ring[k], ring[(k + 1) % size], middle) for k in range(size)]
            continue
        angle = np.pi / 4 * 5 + 2 * np.pi * np.arange(size) / size
        hole = [vertex(centre + r * np.array([np.cos(a), np.sin(a)])) for a in angle]
        for k in range(size):
            following = (k + 1) % size
            faces += [(ring[k], ring[following], hole[following]), (ring[k], hole[following], hole[k])]
    return extruded(points, faces, 0, .5)


def sharp_edges(x, faces, degrees):
    """Pairs of vertices of the edges at which triangles turn by more than this."""
    normal = np.cross(x[faces[:, 1]] - x[faces[:, 0]], x[faces[:, 2]] - x[faces[:, 0]])
    normal /= np.maximum(np.linalg.norm(normal, axis=1), 1e-300)[:, None]
    edges = np.sort(np.concatenate([faces[:, [0, 1]], faces[:, [1, 2]], faces[:, [2, 0]]]), 1)
    face = np.tile(np.arange(len(faces)), 3)
    order = np.lexsort((edges[:, 1], edges[:, 0]))
    edges, face = edges[order], face[order]
    first = np.nonzero((edges[1:] == edges[:-1]).all(1))[0]
    cosine = (normal[face[first]] * normal[face[first + 1]]).sum(1)
    return edges[first][cosine < np.cos(np.radians(degrees))]


def along(lines, step):
    """Points on segments (n, 2, 3), nearer to each other than a step, and the length that each stands for."""
    a, b = lines[:, 0], lines[:, 1]
    length = np.linalg.norm(b - a, axis=1)
    n = np.maximum(1, np.ceil(length / step).astype(int))
    line = np.repeat(np.arange(len(lines)), n)
    t = (np.arange(n.sum()) - np.repeat(np.cumsum(n) - n, n) + .5) / n[line]
    return a[line] + t[:, None] * (b - a)[line], (length / n)[line]


# Bodies -----------------------------------------------------------------------------------------------------------

CUBE = "max(max(abs(x),abs(y)),abs(z))-1"
SQUARE = [(-1, -1), (1, -1), (1, 1), (-1, 1)]
ELL = [(-1, -1), (1, -1), (1, 0), (0, 0), (0, 1), (-1, 1)]


def wedge(degrees):
    half = np.radians(degrees) / 2
    w = min(2, 1 / np.tan(half))
    d, base = w / 2 * np.sin(half), w * np.tan(half)
    formula = f"max(max({np.cos(half):.17g}*abs(y)-{np.sin(half):.17g}*x-{d:.17g},x-{w / 2:.17g}),abs(z)-1)"
    return Body(formula, tuple(prism_edges([(-w / 2, 0), (w / 2, -base), (w / 2, base)], -1, 1)))


def cone(slope):
    """Of height 1.6; its base has the radius slope * 1.6."""
    return Body(f"max(sqrt(x^2+y^2)-{slope}*(.8-z),-.8-z)", (arc((0, 0, -.8), (1.6 * slope, 0, 0), (0, 1.6 * slope, 0)),))


def cube_minus_ball():
    edges = [e for e in prism_edges(SQUARE, -1, 1) if not any((p == 1).all() for p in e)]
    axes = np.eye(3)
    for k in range(3):
        start = np.ones(3) - 2 * axes[k]
        edges.append(np.array([start, start + axes[k]]))
        edges.append(arc((1, 1, 1), -axes[k], -axes[(k + 1) % 3], 0, np.pi / 2))
    return Body(f"max({CUBE},1-(x-1)^2-(y-1)^2-(z-1)^2)", tuple(edges))


def round_edge(radius):
    return (arc((0, 0, 0), (radius, 0, 0), (0, radius, 0)),)


FLANGE = [(.35, -.3), (1.2, -.3), (1.2, 0), (.6, 0), (.6, .7), (.35, .7)]
BODIES = {
    "cube": Body(CUBE, tuple(prism_edges(SQUARE, -1, 1))),
    "L-prism": Body("max(max(max(abs(x),abs(y))-1,min(x,y)),abs(z)-.6)", tuple(prism_edges(ELL, -.6, .6))),
    "cylinder": Body("max(x^2+y^2-1,abs(z)-1)", (arc((0, 0, -1), (1, 0, 0), (0, 1, 0)), arc((0, 0, 1), (1, 0, 0), (0, 1, 0)))),
    "cube minus ball": cube_minus_ball(),
    "lens": Body("max(x^2+y^2+(z-.5)^2-1,x^2+y^2+(z+.5)^2-1)", round_edge(np.sqrt(.75))),
    "two balls": Body("min(x^2+y^2+(z-.7)^2-1,x^2+y^2+(z+.7)^2-1)", round_edge(np.sqrt(.51))),
    "wedge 60": wedge(60),
    "wedge 45": wedge(45),
    "wedge 30": wedge(30),
    "cone 63": cone(.5),
    "cone 45": cone(1),
    "cube, 12 triangles": Body(triangles=extruded(SQUARE, [(0, 1, 2), (0, 2, 3)], -1, 1)),
    "L-prism, 20 triangles": Body(triangles=extruded(ELL, [(0, 1, 2), (0, 2, 3), (0, 3, 4), (0, 4, 5)], -.6, .6)),
    "flange": Body(triangles=revolved(FLANGE, 48)),
    "bracket": Body(triangles=bracket()),
}
PARTS = ("parts/fandisk.obj", "parts/joint.obj", "parts/block.obj", "parts/box.STL", "parts/octagonal_pocket.stl",
         "parts/1002_tray_bottom.STL", "parts/fixed_top.ply", "parts/cycloidal.ply", "field/tm_featuretype.STL",
         "field/openbox.stl")


def triangles_of(file):
    mesh = triangle_mesh.joined(triangle_mesh.read(file))
    x, faces = triangle_mesh.corners(mesh)
    _, first, place = np.unique(np.round((x - x.min(0)) / (1e-6 * np.linalg.norm(np.ptp(x, axis=0)))), axis=0,
                                return_index=True, return_inverse=True)
    faces = place.reshape(-1)[faces]
    is_flat = (faces[:, 0] == faces[:, 1]) | (faces[:, 1] == faces[:, 2]) | (faces[:, 2] == faces[:, 0])
    return x[first], faces[~is_flat]


def wanted(body):
    """The curves that have to be there, as segments (n, 2, 3)."""
    if body.formula:
        return np.concatenate([np.stack([c[:-1], c[1:]], 1) for c in body.curves])
    x, faces = body.triangles
    return x[sharp_edges(x, faces, SHARP)]


def moved(body, turn, offset):
    """Rotated about the origin, then moved."""
    if body.triangles:
        x, faces = body.triangles
        return Body(triangles=(x @ turn.T + offset, faces))
    back = dict(zip("xyz", (f"({axis}-({o:.17g}))" for axis, o in zip("xyz", offset))))
    formula = re.sub(r"\b[xyz]\b", lambda m: back[m.group()], rotated_formula(body.formula, turn.T))
    return Body(formula, tuple(c @ turn.T + offset for c in body.curves))


# Meshes -----------------------------------------------------------------------------------------------------------

class Mesh(NamedTuple):
    n_tets: int
    q_min: float
    q_p01: float
    least: float
    most: float
    missed: float
    points: np.ndarray
    tets: np.ndarray


def measured(file, body):
    with contextlib.redirect_stdout(io.StringIO()):  # meshio prints an empty line
        points, tets = tet_mesh.read(file)[:2]
    q, least, most = measures(points, tets)
    signed = tet_mesh.signed_volumes(points, tets)
    if np.median(signed) < 0:
        tets = tets[:, [1, 0, 2, 3]]
    faces = boundary_faces(tets)
    h = np.linalg.norm(points[faces[:, 0]] - points[faces[:, 1]], axis=1).mean()
    want, length = along(wanted(body), STEP * h)
    have = along(points[sharp_edges(points, faces, IS_EDGE)], STEP * h)[0]
    distance = cKDTree(have).query(want)[0] if len(have) else np.full(len(want), np.inf)
    missed = length[distance > OFF * h].sum() / length.sum() if len(want) else 0
    return Mesh(len(tets), q.min(), np.quantile(q, .01), least, most, missed, points, tets)


def write_off(x, faces, file):
    with open(file, "w", encoding="utf8") as f:
        print(f"OFF\n{len(x)} {len(faces)} 0", file=f)
        for p in x:
            print(*(f"{c:.17g}" for c in p), file=f)
        for t in faces:
            print("3", *t, file=f)


def write_obj(x, faces, file):
    with open(file, "w", encoding="utf8") as f:
        for p in x:
            print("v", *(f"{c:.17g}" for c in p), file=f)
        for t in faces:
            print("f", *(t + 1), file=f)


def write_stl(x, faces, file):
    with open(file, "w", encoding="utf8") as f:
        print("solid body", file=f)
        for t in faces:
            print("facet normal 0 0 0\nouter loop", file=f)
            for p in x[t]:
                print("vertex", *(f"{c:.17g}" for c in p), file=f)
            print("endloop\nendfacet", file=f)
        print("endsolid body", file=f)


def skin(points, tets):
    used, faces = np.unique(boundary_faces(tets), return_inverse=True)
    return points[used], faces.reshape(-1, 3)


def of_umtet(umtet, body, folder, flags=()):
    """The run, and the file of the mesh."""
    case = folder / "umtet"
    shutil.rmtree(case, ignore_errors=True)
    if body.formula:
        r = RADIUS + H
        words = ["mesh", "--implicit=" + body.formula, "--box=" + ",".join([f"{-r:g}"] * 3 + [f"{r:g}"] * 3),
                 *(flags or ["--h", str(H)])]
    else:
        write_obj(*body.triangles, folder / "body.obj")
        words = ["run", folder / "body.obj", *flags]
    done = timed([umtet, *words, "--no-report", "--progress", "none", "--threads", "1", "-o", case])
    return done, case / "3-mesh" / "mesh.vtu"


def of_tetgen(x, faces, edge, folder):
    write_off(x, faces, folder / "tetgen.off")
    for old in folder.glob("tetgen.1.*"):
        old.unlink()
    volume = edge**3 / (6 * np.sqrt(2))
    done = timed(["tetgen", f"-pq1.2/14O9/7o/130a{volume:.9f}gQ", folder / "tetgen.off"], SECONDS)
    return done, folder / "tetgen.1.mesh"


GEO = """Merge "gmsh.stl";
ClassifySurfaces{{{angle}, 1, 0, Pi}};
CreateGeometry;
Surface Loop(1) = Surface{{:}};
Volume(1) = {{1}};
Mesh.MeshSizeMin = {edge};
Mesh.MeshSizeMax = {edge};
Mesh.MeshSizeExtendFromBoundary = 0;
Mesh.Algorithm3D = 10;
Mesh.OptimizeThreshold = .5;
"""


def of_gmsh(x, faces, edge, folder):
    write_stl(x, faces, folder / "gmsh.stl")
    (folder / "gmsh.geo").write_text(GEO.format(angle=np.radians(SHARP), edge=edge), encoding="utf8")
    (folder / "gmsh.msh").unlink(missing_ok=True)
    done = timed(["gmsh", "-3", "-nt", "1", "-v", "1", "-format", "msh41", "-o", folder / "gmsh.msh", folder / "gmsh.geo"], SECONDS)
    return done, folder / "gmsh.msh"


def of_cgal(program):
    def made(x, faces, edge, folder):
        write_off(x, faces, folder / "cgal.off")
        (folder / "cgal.mesh").unlink(missing_ok=True)
        done = timed([program, folder / "cgal.off", f"{edge:.9g}", SHARP, folder / "cgal.mesh"], SECONDS)
        return done, folder / "cgal.mesh"
    return made


def sized(mesher, body, triangles, n_tets, edge, folder):
    """The mesh whose number of tets is nearest to what is asked for, of three."""
    best, why = None, ""
    for _ in range(3):
        done, file = mesher(*triangles, edge, folder)
        if done.code != 0 or not file.exists():
            why = f"none: more than {SECONDS} s" if done.code == TIMEOUT else f"none: exit {done.code}"
            break
        mesh = measured(file, body)
        ratio = mesh.n_tets / n_tets
        if best is None or abs(np.log(ratio)) < abs(np.log(best[0].n_tets / n_tets)):
            best = mesh, done.cpu
        if max(ratio, 1 / ratio) < ENOUGH:
            break
        edge *= ratio**(1 / 3)
    return best, why


# Rows -------------------------------------------------------------------------------------------------------------

def row(*cells):
    print("| " + " | ".join(str(c) for c in cells) + " |", flush=True)


def positions(n, seed=1):
    random = np.random.default_rng(seed + 1)
    for k, turn in enumerate(rotations(n + 1, seed)):
        if k > 0:
            yield turn, random.uniform(-H / 2, H / 2, 3)


def row_of_positions(umtet, name, body, n, folder):
    found, codes, curves = [], {}, "-"
    for turn, offset in positions(n):
        here = moved(body, turn, offset)
        done, file = of_umtet(umtet, here, folder)
        codes[done.code] = codes.get(done.code, 0) + 1
        if not file.exists():
            continue
        m = measured(file, here)
        curves = certified(folder / "umtet", "features", "curves") or curves
        found.append((m.n_tets, m.q_min, m.q_p01, m.least, m.most, m.missed, done.cpu))
    exits = ", ".join(f"{code}: {count}" for code, count in sorted(codes.items()) if code) or "0"
    if not found:
        row(name, curves, n, *["-"] * 6, exits)
        return
    middle, low, high = np.median(found, 0), np.min(found, 0), np.max(found, 0)
    row(name, curves, n, f"{middle[0]:,.0f}", f"{low[1]:.3f} / {middle[1]:.3f}", f"{low[2]:.3f}",
        f"{low[3]:.1f} to {high[4]:.1f}", f"{100 * high[5]:.2g}", f"{middle[6]:.1f}", exits)


def rows_of_tools(umtet, name, body, cgal, folder):
    turn, offset = next(positions(1))
    here = moved(body, turn, offset)

    def show(tool, mesh, cpu):
        row(name, tool, f"{mesh.n_tets:,}", f"{mesh.q_min:.3f}", f"{mesh.q_p01:.3f}", f"{mesh.least:.1f} to {mesh.most:.1f}",
            f"{100 * mesh.missed:.2g}", f"{cpu:.1f}")

    done, file = of_umtet(umtet, here, folder)
    if not file.exists():
        row(name, "umtet", f"none: exit {done.code}", *[""] * 5)
        return
    ours = measured(file, here)
    show("umtet", ours, done.cpu)
    triangles = kept = here.triangles
    if not triangles:  # TetGen keeps all triangles, the others make their own
        kept = skin(ours.points, ours.tets)
        _, file = of_umtet(umtet, here, folder, ["--h", str(H / FINER)])
        triangles = skin(*tet_mesh.read(file)[:2])
    volume = np.abs(tet_mesh.signed_volumes(ours.points, ours.tets)).sum()
    edge = (6 * np.sqrt(2) * volume / ours.n_tets)**(1 / 3)
    tools = [("TetGen", "tetgen", of_tetgen), ("Gmsh HXT .5", "gmsh", of_gmsh), ("CGAL Mesh_3", cgal, of_cgal(cgal))]
    for tool, program, mesher in tools:
        if not program or not shutil.which(program):
            continue
        best, why = sized(mesher, here, kept if tool == "TetGen" else triangles, ours.n_tets, edge, folder)
        if best:
            show(tool, *best)
        else:
            row(name, tool, why, *[""] * 5)


def main():
    words = sys.argv[1:]
    options = dict(a[2:].split("=", 1) if "=" in a else (a[2:], "") for a in words if a.startswith("--"))
    umtet, *names = [a for a in words if not a.startswith("--")]
    bodies = dict(BODIES)
    if "shared" in options:
        for part in PARTS:
            file = pathlib.Path(options["shared"]) / "data" / part
            if file.exists():
                bodies[file.stem.removeprefix("tm_")] = Body(triangles=triangles_of(file))
    with_peers = "peers" in options or "cgal" in options
    quality = ["least Q", "1 % Q", "dihedral angles", "missed, %", "CPU s"]
    columns = ["body", "tool", "tets", *quality] if with_peers else ["body", "curves", "positions", "tets", *quality, "exit"]
    row(*columns)
    print("|---" * len(columns) + "|", flush=True)
    with tempfile.TemporaryDirectory() as temporary:
        for name in names or bodies:
            folder = pathlib.Path(options.get("folder", temporary)) / name.replace(" ", "_").replace(",", "")
            shutil.rmtree(folder, ignore_errors=True)
            folder.mkdir(parents=True)
            if with_peers:
                rows_of_tools(umtet, name, bodies[name], options.get("cgal", ""), folder)
            else:
                row_of_positions(umtet, name, bodies[name], int(options.get("positions", 1)), folder)


if __name__ == "__main__":
    main()
