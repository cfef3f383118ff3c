#!/usr/bin/python3
"""What comes of triangles that do not bound a body as they should: one row of Markdown each.

usage: soups.py UMTET [MESH.ply ...] [--timeout=150]

Bodies are a torus of 10,000 triangles, a cube of 12 and the files. Each is given as binary STL: as it is; with a tenth
of its triangles turned over; with a twentieth removed; with all corners moved on their own by up to 1e-4 diagonals; with
a copy of itself a sixth of the diagonal away, as one soup; with an inner wall; inside of a box, looking outward and
inward. h is 1.5 % of the diagonal. Distances are in 1e-4 of it, mesh to triangles / triangles to mesh, rms and largest.
"""
import pathlib
import sys
import tempfile

import numpy as np

import triangle_mesh
from case import certified, number, reason, run, shown


def torus(n=100, m=50, R=1., r=.4):
    u, v = np.meshgrid(np.arange(n) * 2 * np.pi / n, np.arange(m) * 2 * np.pi / m, indexing="ij")
    x = np.stack([(R + r * np.cos(v)) * np.cos(u), (R + r * np.cos(v)) * np.sin(u), r * np.sin(v)], -1).reshape(-1, 3)
    i, j = np.meshgrid(np.arange(n), np.arange(m), indexing="ij")
    a, b, c, d = (((i + k) % n * m + (j + l) % m).ravel() for k, l in ((0, 0), (1, 0), (1, 1), (0, 1)))
    return x[np.concatenate([np.stack([a, b, c], 1), np.stack([a, c, d], 1)])]


def cube():
    x = np.array([[i, j, k] for i in (0, 1) for j in (0, 1) for k in (0, 1)], float)
    quads = [(0, 1, 3, 2), (4, 6, 7, 5), (0, 4, 5, 1), (2, 3, 7, 6), (0, 2, 6, 4), (1, 5, 7, 3)]
    return x[[t for a, b, c, d in quads for t in ((a, b, c), (a, c, d))]]


def from_file(file):
    x, faces = triangle_mesh.corners(triangle_mesh.read(file))
    return x[faces]


def diagonal(t):
    return np.linalg.norm(np.ptp(t.reshape(-1, 3), axis=0))


def wall(t):
    """Two triangles across the middle of its box, a third as wide as it."""
    low, high = t.reshape(-1, 3).min(0), t.reshape(-1, 3).max(0)
    middle, size = (low + high) / 2, (high - low) / 6
    a, b, c, d = (middle + size * np.array([0, i, k]) for i, k in ((-1, -1), (1, -1), (1, 1), (-1, 1)))
    return np.array([[a, b, c], [a, c, d]])


def variants(t, wall_here):
    random = np.random.default_rng(1)
    low, high = t.reshape(-1, 3).min(0), t.reshape(-1, 3).max(0)
    d, centre = np.linalg.norm(high - low), (low + high) / 2
    yield "clean", t
    turned = t.copy()
    some = random.random(len(t)) < .1
    turned[some] = turned[some][:, ::-1]
    yield "10 % turned", turned
    yield "5 % removed", t[random.random(len(t)) >= .05]
    yield "split, jittered 1e-4", t + random.uniform(-1e-4, 1e-4, t.shape) * d
    yield "all three", (turned + random.uniform(-1e-4, 1e-4, t.shape) * d)[random.random(len(t)) >= .05]
    yield "with a copy", np.concatenate([t, t + np.array([.02, .03, .17]) * d])
    yield "inner wall", np.concatenate([t, wall_here])
    big = centre + 1.5 * (high - low) * (cube() - .5)
    yield "in a shell", np.concatenate([t, big])
    yield "as a cavity", np.concatenate([t[:, ::-1], big])


def write_stl(file, t):
    record = np.zeros(len(t), np.dtype([("n", "<f4", 3), ("x", "<f4", (3, 3)), ("a", "<u2")]))
    record["x"] = t
    file.write_bytes(bytes(80) + np.uint32(len(t)).tobytes() + record.tobytes())


def main():
    options = dict(a[2:].split("=", 1) for a in sys.argv[1:] if a.startswith("--"))
    umtet, *files = [a for a in sys.argv[1:] if not a.startswith("--")]
    bodies = [("torus", torus(), wall(torus()) + np.array([1, 0, 0])), ("cube", cube(), wall(cube()))]
    bodies += [(pathlib.Path(f).stem, from_file(f), wall(from_file(f))) for f in files]
    header = ["body", "soup", "triangles", "exit", "pieces", "genus", "min Q", "tets", "CPU s", "turned", "inside %",
              "unsure %", "to rms / max", "back rms / max"]
    print("|", " | ".join(header), "|\n" + "|---" * len(header) + "|", flush=True)
    with tempfile.TemporaryDirectory() as temporary:
        folder = pathlib.Path(temporary)
        for name, body, wall_here in bodies:
            for soup, t in variants(body, wall_here):
                write_stl(folder / "soup.stl", t)
                case = folder / "case"
                done = run(umtet, folder / "soup.stl", case, ["--h", str(.015 * diagonal(t))],
                           timeout=float(options.get("timeout", 150)))
                told = number(case, "1-cloud/record.json", "numbers", "triangles") or {}
                d = certified(case, "triangles") or {}
                unit = 1e4 / diagonal(t)

                def cell(key, scale=1., form=".3g"):
                    value = d.get(key)
                    return shown(None if value is None else value * scale, 0, form)

                inside = 100 * told["n_samples_inside"] / told["n_samples"] if told else None
                cells = [name, soup, str(len(t)), str(done.code), shown(certified(case, "boundary", "components"), 0),
                         shown(certified(case, "boundary", "genus"), 0), shown(certified(case, "quality", "min"), 0, ".3f"),
                         shown(certified(case, "n_tets"), 0), f"{done.cpu:.1f}", shown(told.get("n_turned"), 0),
                         shown(inside, 0, ".1f"), shown(100 * told["unsure"] if told else None, 0, ".1f"),
                         f"{cell('rms_distance', unit)} / {cell('max_distance', unit)}",
                         f"{cell('rms_distance_back', unit)} / {cell('max_distance_back', unit)}"]
                print("|", " | ".join(cells), "|", reason(done, case), flush=True)


if __name__ == "__main__":
    main()
