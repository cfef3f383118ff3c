#!/usr/bin/python3
"""Clouds with noise along the normals and with outliers: what umtet takes for noise, how far its mesh is from the
truth.

usage: noisy.py UMTET [BODY ...] [--points=50000] [--noise=.1,.25,.5,1] [--outliers=0,5] [--normals=estimate]
                [--clean] [--poisson=PROGRAM] [--timeout=150] [--keep=FOLDER]

       noisy.py UMTET --seeds=10 [BODY ...] [--noise=.25,.5,1,1.7] [--normals=both|given|estimate] [--timeout=150]

Bodies are ball, torus, eq_9, duck and PATH.ply, a mesh that is closed; eq_9 and duck if none is named. Samples are
white noise on the surface, their normals are exact. Noise is in percent of the diagonal of the body; outliers are in
percent of the points, uniform in the body's box grown by a tenth. --clean adds clouds without noise, and of eq_9 one
of ten times as many points. PROGRAM is that of cgal_poisson.cpp; its distances stand beside ours. Exit 124 is more
seconds than its timeout.

All lengths are over the diagonal: noise, lattice and h in percent, distances in 1e-4. "est." is umtet's estimate of the
noise, "dropped" the number of points that it takes for outliers. psi/est and psi/true are the rms of psi at the others
over the noise; in/true is the rms distance of all true samples to the mesh over it. "to" is from the mesh's vertices to
the truth, "from" is from points of the truth to the mesh.

With --seeds one row is so many clouds: ball, torus and trefoil of 8,000 new points, the cloud duck, and the armadillo
of shared/data; noise is in spacings, the root of the area of a sample, along the normal or in all directions; normals
are the true ones or none. Right is exit 0, the genus, and a volume within 3 % (5 % from a noise of 1.5 on) in under
twice the CPU time of the clean cloud; volumes are against the formula, of the clouds against that of the mesh of the
clean one. "turned" counts normals that the winding number turned.
"""
import os
import sys
import tempfile

import numpy as np
from scipy.spatial import cKDTree

import bodies
from case import boundary, both_distances, certified, number, poisson, reason, run, shown
from cloud_files import read_ply, write_ply
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


SPACINGS = {"ball": (.25, .5, 1, 1.7), "torus": (.25, .5, 1, 1.7), "duck": (.25, .5, 1, 1.7), "trefoil": (.25, .5),
            "armadillo": (.25, .5)}
SEEDED = {"ball": (bodies.random_ball, 0, 4 / 3 * np.pi), "torus": (bodies.random_torus, 1, 2 * np.pi**2 * .4**2),
          "trefoil": (bodies.random_trefoil, 1, bodies.trefoil_volume())}


def spacing_of(points):
    """Root of the mean area of a sample, as sample_areas() has it."""
    k = 12
    d = cKDTree(points).query(points, k + 1)[0]
    return np.sqrt(np.mean(2 * np.pi / (k * (k + 2)) * np.sum(d * d, 1)))


class Seeded:
    """Clouds of a body: clean(seed) has points and unit normals."""

    def __init__(self, name):
        self.name = name
        if name in SEEDED:
            make, self.genus, self.volume = SEEDED[name]
            self.clean = lambda seed: make(np.random.default_rng(seed), 8000)
        else:
            file = bodies.SHARED / "data/armadillo.ply" if name == "armadillo" else None
            points, normals = read_ply(file)[:2] if file else bodies.cloud(name)
            normals = normals / np.linalg.norm(normals, axis=1)[:, None]
            self.genus, self.volume = {"duck": 1}.get(name, 0), None
            self.clean = lambda seed: (points, normals)

    def noisy(self, spacings, kind, seed):
        points, normals = self.clean(seed)
        random = np.random.default_rng(1000 + seed)
        off = random.standard_normal((len(points), 3 if kind == "isotropic" else 1))
        return points + spacings * spacing_of(points) * (off if kind == "isotropic" else off * normals), normals


def seeds_table(umtet, names, options):
    n_seeds, timeout = int(options["seeds"]), float(options.get("timeout", 150))
    which = {"given": [True], "estimate": [False]}.get(options.get("normals"), [True, False])
    print("body       noise kind      normals  right exits genus volume  time   volume off %       CPU s  clean   "
          "h/noise   tets turned  wrong seeds")
    with tempfile.TemporaryDirectory() as folder:
        cloud, case = os.path.join(folder, "cloud.ply"), os.path.join(folder, "case")
        for body in map(Seeded, names or SPACINGS):
            for given in which:
                points, normals = body.clean(0)
                write_ply(cloud, points, normals if given else None)
                clean = min((run(umtet, cloud, case, timeout=timeout) for _ in range(2)), key=lambda done: done.cpu)
                volume = body.volume or certified(case, "volume") or np.nan
                noises = [float(x) for x in options["noise"].split(",")] if "noise" in options else SPACINGS[body.name]
                for spacings in noises:
                    for kind in ("isotropic", "normal"):
                        rows, wrong = [], []
                        for seed in range(1, n_seeds + 1):
                            points, normals = body.noisy(spacings, kind, seed)
                            write_ply(cloud, points, normals if given else None)
                            done = run(umtet, cloud, case, timeout=timeout)
                            off = 100 * ((certified(case, "volume") or np.nan) / volume - 1)
                            is_right = [done.code == 0, certified(case, "boundary", "genus") == body.genus,
                                        abs(off) <= (3 if spacings < 1.5 else 5), done.cpu <= 2 * clean.cpu]
                            turned = number(case, "1-cloud/record.json", "numbers", "normals", "turned_by_winding")
                            rows.append([*is_right, off, done.cpu, certified(case, "cloud", "noise_over_h") or np.nan,
                                         certified(case, "n_tets") or 0, turned or 0])
                            if not all(is_right):
                                wrong.append(f"{seed}:{done.code}:{certified(case, 'boundary', 'genus')}")
                        table = np.array(rows, float)
                        with np.errstate(all="ignore"):
                            print(f"{body.name:10} {spacings:5} {kind:9} {'given' if given else 'none':7} "
                                  f"{n_seeds - len(wrong):3}/{n_seeds:<3}"
                                  + "".join(f"{int(table[:, k].sum()):6}" for k in range(4))
                                  + f"  {np.nanmin(table[:, 4]):7.2f} {np.nanmax(table[:, 4]):6.2f}"
                                  f" {np.median(table[:, 5]):6.2f} {table[:, 5].max():6.2f} {clean.cpu:6.2f}"
                                  f" {np.nanmedian(table[:, 6]):7.3f} {np.median(table[:, 7]):8.0f}"
                                  f" {np.median(table[:, 8]):6.0f}  {' '.join(wrong)}", flush=True)


def main():
    options = dict((a[2:] + "=").split("=")[:2] for a in sys.argv[1:] if a.startswith("--"))
    umtet, *names = [a for a in sys.argv[1:] if not a.startswith("--")]
    if "seeds" in options:
        seeds_table(umtet, names, options)
        return
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
