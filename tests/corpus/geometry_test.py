#!/usr/bin/python3
"""Clouds that the theory does not cover, meshed by the program from outside: each ends in a mesh that is checked here
without umtet (volumes, closed boundary, volume of the body, distance of the samples), or in a named exit code with its
reason. Never a wrong mesh with exit 0. usage: tests/corpus/geometry_test.py UMTET [SHAPE ...]"""
import json
import pathlib
import subprocess
import sys
import tempfile

import meshio
import numpy as np
from scipy.spatial import cKDTree

FACES = np.array([[1, 2, 3], [0, 3, 2], [0, 1, 3], [0, 2, 1]])  # outward for positive tets


def sphere(n, radius=1.0, centre=(0, 0, 0)):
    """n points x y z nx ny nz of a golden spiral."""
    i = np.arange(n)
    z, a = 1 - (2 * i + 1) / n, np.pi * (3 - 5**.5) * i
    normal = np.column_stack([np.sqrt(1 - z * z) * np.cos(a), np.sqrt(1 - z * z) * np.sin(a), z])
    return np.hstack([np.array(centre) + radius * normal, normal])


def box(size, spacing):
    """Regular points of the six faces, none on an edge."""
    size, rows = np.asarray(size, float), []
    for axis in range(3):
        u, v = [(np.arange(n) + .5) / n for n in np.maximum(1, np.rint(np.delete(size, axis) / spacing)).astype(int)]
        for side in (0, 1):
            x, n = np.zeros((len(u) * len(v), 3)), np.zeros((len(u) * len(v), 3))
            grid = np.stack(np.meshgrid(u, v, indexing="ij"), -1).reshape(-1, 2) * np.delete(size, axis)
            x[:, [a for a in range(3) if a != axis]] = grid
            x[:, axis], n[:, axis] = side * size[axis], 2 * side - 1
            rows.append(np.hstack([x, n]))
    return np.vstack(rows)


def plate(thickness, n):
    """Two squares, without a rim."""
    rows = np.zeros((n, 6))
    rows[:, :2] = np.random.default_rng(3).uniform(-1, 1, (n, 2))
    rows[:, 5] = np.where(np.arange(n) % 2 == 0, 1, -1)
    rows[:, 2] = thickness / 2 * rows[:, 5]
    return rows


def plane(noise):
    rows = np.zeros((900, 6))
    rows[:, :2] = np.stack(np.meshgrid(*[np.arange(30) / 30.] * 2), -1).reshape(-1, 2)
    rows[:, 2] = noise * np.random.default_rng(1).standard_normal(900)
    rows[:, 5] = 1
    return rows


def distance_to(samples, points, triangles):
    """Distances from samples to triangles, exact for the 12 whose centres are nearest."""
    corners = points[triangles]
    _, near = cKDTree(corners.mean(1)).query(samples, min(12, len(triangles)))
    best = np.full(len(samples), np.inf)
    for tri in corners[near].transpose(1, 0, 2, 3):
        a, ab, ac = tri[:, 0], tri[:, 1] - tri[:, 0], tri[:, 2] - tri[:, 0]
        x, n = samples - a, np.cross(ab, ac)
        d00, d01, d11 = (ab * ab).sum(1), (ab * ac).sum(1), (ac * ac).sum(1)
        d20, d21 = (x * ab).sum(1), (x * ac).sum(1)
        det = d00 * d11 - d01 * d01
        v, w = (d11 * d20 - d01 * d21) / det, (d00 * d21 - d01 * d20) / det
        inside = (v >= 0) & (w >= 0) & (v + w <= 1)
        best = np.where(inside, np.minimum(best, np.abs((x * n).sum(1)) / np.linalg.norm(n, axis=1)), best)
        for k in range(3):
            p, e = tri[:, k], tri[:, (k + 1) % 3] - tri[:, k]
            t = np.clip(((samples - p) * e).sum(1) / (e * e).sum(1), 0, 1)[:, None]
            best = np.minimum(best, np.linalg.norm(samples - p - t * e, axis=1))
    return best


def measure(file, samples):
    """What a mesh is, from its file alone."""
    mesh = meshio.read(file)
    points, tets = mesh.points, np.vstack([c.data for c in mesh.cells if c.type == "tetra"])
    edges = points[tets[:, 1:]] - points[tets[:, :1]]
    volumes = np.linalg.det(edges) / 6
    faces = tets[:, FACES].reshape(-1, 3)
    _, first, count = np.unique(np.sort(faces, 1), axis=0, return_index=True, return_counts=True)
    boundary = faces[first[count == 1]]
    _, shared = np.unique(np.sort(boundary[:, [[0, 1], [1, 2], [2, 0]]].reshape(-1, 2), 1), axis=0, return_counts=True)
    distances = distance_to(samples, points, boundary)
    return {"least": volumes.min(), "volume": volumes.sum(), "closed": bool((shared == 2).all() and (count <= 2).all()),
            "farthest": distances.max(), "tets": len(tets)}


ONE_SIDED = ((4,), ["reaches the wall", "the surface is closed"])
TOO_NEAR = ((4, 6), ["two sides of a body were closer to each other than its samples"])
# Cloud, arguments, and what must come of it: volume, how far it may be off, and how far the farthest sample may be from
# the mesh; or exit codes and words of the reason.
SHAPES = {
    "cube": (box((1, 1, 1), .05), ["--h", ".05"], (1, .01, .03)),
    "cube of few samples": (box((1, 1, 1), .12), ["--h", ".05"], (1, .02, .07)),
    "box of few samples": (box((1, .6, .3), .08), ["--h", ".05"], (.18, .01, .05)),
    "box of many samples": (box((2, 1, .2), .025), [], (.4, .005, .02)),
    "plate thinner than its samples are apart": (box((1, 1, .004), .03), ["--h", ".03"], TOO_NEAR),
    "the same, its samples at random": (plate(.004, 4000), ["--h", ".03"], TOO_NEAR),
    "half a sphere": (sphere(1500)[:750], [], (2.1, .2, .02)),
    "half a sphere, left open": (sphere(1500)[:750], ["--keep-open"], ONE_SIDED),
    "sheets nearer than samples": (np.vstack([sphere(3000), sphere(2000, .95) * [1, 1, 1, -1, -1, -1]]), ["--h", ".1"],
                                   ((6,), ["body down to", "needs h ="])),
    "h beyond the body": (sphere(500), ["--h", "50"], ((6,), ["volume_gap"])),  # a ball of 20 tets
    "h too small": (sphere(500), ["--h", "1e-12"], ((9,), ["more than 2000000 tets"])),
    "plane": (plane(0), [], ((3,), ["one plane"])),
    "noisy plane": (plane(.003), [], ONE_SIDED),
}


def run(program, cloud, arguments):
    """Exit code, text of stderr, verdict, and what the mesh is where there should be one."""
    with tempfile.TemporaryDirectory() as temporary:
        folder = pathlib.Path(temporary)
        np.savetxt(folder / "cloud.xyz", cloud, "%.17g")
        r = subprocess.run([program, "run", str(folder / "cloud.xyz"), "-o", str(folder / "case"), "--json", *arguments],
                           capture_output=True, text=True)
        if r.returncode != 0:
            return r.returncode, r.stderr + r.stdout, None, None
        verdict = json.loads(r.stdout)["certificate"]["verdict"]
        return 0, r.stderr, verdict, measure(folder / "case/3-mesh/mesh.vtu", cloud[:, :3])


def troubles(expected, code, err, verdict, mesh):
    if isinstance(expected[1], list):
        if code not in expected[0]:
            yield f"exit {code} instead of {expected[0]}"
        yield from (f"'{word}' is missing" for word in expected[1] if word not in err)
        return
    volume, tolerance, farthest = expected
    if code != 0 or verdict != "pass":
        yield f"exit {code}, verdict {verdict}"
        return
    if not (mesh["least"] > 0 and mesh["closed"]):
        yield "a tet that is not positive, or a boundary that is not closed"
    if abs(mesh["volume"] - volume) > tolerance:
        yield f"volume {mesh['volume']:.4g} instead of {volume:.4g}"
    if mesh["farthest"] > farthest:
        yield f"a sample is {mesh['farthest']:.3g} from the mesh"


def main():
    n_bad = 0
    for name in sys.argv[2:] or SHAPES:
        cloud, arguments, expected = SHAPES[name]
        code, err, verdict, mesh = run(sys.argv[1], cloud, arguments)
        found = list(troubles(expected, code, err, verdict, mesh))
        n_bad += len(found) > 0
        print(f"{name}: {'; '.join(found) or 'as expected'}: exit {code}, {mesh}")
        if found:
            print(err.strip()[-600:])
    return n_bad > 0


if __name__ == "__main__":
    sys.exit(main())
