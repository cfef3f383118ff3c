#!/usr/bin/python3
"""Clouds with noise along the normals and with outliers: what umtet takes for noise, how far its mesh is from the
truth.

usage: noisy.py UMTET [BODY ...] [--points=50000] [--noise=.1,.25,.5,1] [--outliers=0,5] [--normals=estimate]
                [--clean] [--poisson=PROGRAM] [--timeout=150] [--keep=FOLDER]

Bodies are ball, torus, eq_9, duck and PATH.ply, a mesh that is closed; eq_9 and duck if none is named. Samples are
white noise on the surface, their normals are exact. Noise is in percent of the diagonal of the body; outliers are in
percent of the points, uniform in the body's box grown by a tenth. --clean adds clouds without noise, and of eq_9 one
of ten times as many points. PROGRAM is that of cgal_poisson.cpp; its distances stand beside ours. Exit 124 is more
seconds than its timeout.

All lengths are over the diagonal: noise, lattice and h in percent, distances in 1e-4. "est." is umtet's estimate of the
noise, "dropped" the number of points that it takes for outliers. psi/est and psi/true are the rms of psi at the others
over the noise; in/true is the rms distance of all true samples to the mesh over it. "to" is from the mesh's vertices to
the truth, "from" is from points of the truth to the mesh.
"""
import os
import sys
import tempfile

import numpy as np

import bodies
from case import boundary, both_distances, certified, number, poisson, reason, run, shown
from cloud_files import write_ply
from triangle_mesh import distances

PEERS = {  # SSDRecon and PoissonRecon of M. Kazhdan on eq. (9), measured on 2026-11-21: shared/peers.md. Mean / max.
    (50_000, 0): "SSDRecon .36 / 3.7 (depth 7), .14 / 3.6 (8); PoissonRecon .53 / 5.1 (7), .52 / 10 (8)",
    (500_000, 0): "SSDRecon .024 / .25 (depth 9); PoissonRecon .15 / 3.8 (9)",
    (50_000, .5): "SSDRecon 6.4 (depth 6), 10 (8); PoissonRecon 3.6 (6), 7.0 (8)"}


def noisy(body, n, noise, outliers):
    """Points, normals, number of true samples, which come first. Noise is a length, outliers are a share."""
    random = np.random.default_rng(11)
    n_outliers = round(outliers * n)
    points, normals = body.sample(n - n_outliers, 3)
    points = points + noise * random.standard_normal((len(points), 1)) * normals
    low, high = np.array(body.mesh.GetBounds()).reshape(3, 2).T
    grown = .05 * (high - low)
    more = random.uniform(low - grown, high + grown, (n_outliers, 3))
    directions = random.standard_normal((n_outliers, 3))
    directions /= np.linalg.norm(directions, axis=1, keepdims=True)
    return np.vstack([points, more]), np.vstack([normals, directions]), len(points)


def ours(umtet, body, points, n_true, noise, cloud, case):
    """A row of the table, the mean distances both ways, and what went wrong."""
    done, diagonal = run(umtet, cloud, case), body.diagonal()
    mesh = boundary(umtet, case)
    there, back = both_distances(body, mesh)
    estimated, spacing, rms = (number(case, "2-level-set/record.json", "numbers", key) or np.nan
                               for key in ("noise", "spacing", "rms_value"))
    h = certified(case, "h") or np.nan
    with np.errstate(divide="ignore", invalid="ignore"):
        left = np.nan if mesh is None or not noise else np.sqrt(np.mean(distances(points[:n_true], mesh)**2)) / noise
        ratios = np.array([rms / estimated, rms / noise if noise else np.nan, left])
    row = [shown(done.code, 4), shown(100 * estimated / diagonal, 6, ".3f"),
           shown(number(case, "1-cloud/record.json", "numbers", "dropped", "outliers"), 7),
           shown(100 * spacing / diagonal, 7, ".3f"), *(shown(r, 8, ".3f") for r in ratios),
           shown(100 * h / diagonal, 6, ".3f"), shown(certified(case, "cloud", "noise_over_h"), 7, ".3f"),
           shown(certified(case, "n_tets"), 8), shown(certified(case, "boundary", "genus"), 5), shown(body.genus, 5),
           shown(certified(case, "quality", "min"), 6, ".3f"),
           *(shown(1e4 * f(d), 8, ".3f") for d in (there, back) for f in (np.mean, np.max)), shown(done.cpu, 6, ".1f")]
    return " ".join(row), there.mean(), back.mean(), reason(done, case)


def theirs(program, timeout, body, cloud, file, there, back):
    done, mesh = poisson(program, cloud, file, timeout)
    to, from_ = (d.mean() for d in both_distances(body, mesh))
    return " ".join(["  |", shown(done.code, 4), shown(1e4 * to, 8, ".3f"), shown(1e4 * from_, 8, ".3f"),
                     shown(done.cpu, 6, ".1f"), shown(there / to, 6, ".2f"), shown(back / from_, 6, ".2f")])


def settings(body, options):
    """Points, noise and outliers in percent."""
    n = int(options.get("points", 50_000))
    if "clean" in options:
        yield n, 0, 0
        if body.name == "eq_9":
            yield 10 * n, 0, 0
    for outliers in options.get("outliers", "0,5").split(","):
        for noise in options.get("noise", ".1,.25,.5,1").split(","):
            yield n, float(noise), float(outliers)


def main():
    options = dict((a[2:] + "=").split("=")[:2] for a in sys.argv[1:] if a.startswith("--"))
    umtet, *names = [a for a in sys.argv[1:] if not a.startswith("--")]
    program, timeout = options.get("poisson"), float(options.get("timeout", 150))
    print("body       points noise outl. exit   est. dropped lattice  psi/est psi/true  in/true      h noise/h     "
          "tets genus right  min Q  to mean      max from mean    max  CPU s" +
          ("   | CGAL's: exit, to, from, CPU s; ours / CGAL's" if program else ""))
    with tempfile.TemporaryDirectory() as temporary:
        folder = options.get("keep", temporary)
        os.makedirs(folder, exist_ok=True)
        for body in map(bodies.body, names or ["eq_9", "duck"]):
            for n, percent, outliers in settings(body, options):
                noise = percent / 100 * body.diagonal()
                points, normals, n_true = noisy(body, n, noise, outliers / 100)
                case = os.path.join(folder, f"{body.name}_{n}_{percent:g}_{outliers:g}")
                write_ply(case + ".ply", points, None if options.get("normals") == "estimate" else normals)
                row, there, back, error = ours(umtet, body, points, n_true, noise, case + ".ply", case)
                if program:
                    row += theirs(program, timeout, body, case + ".ply", case + "_poisson.ply", there, back)
                print(f"{body.name:10.10} {n:6} {percent:5} {outliers:5} {row} {error}", flush=True)
                if body.name == "eq_9" and outliers == 0 and (n, percent) in PEERS:
                    print("           " + PEERS[n, percent], flush=True)


if __name__ == "__main__":
    main()
