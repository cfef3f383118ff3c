#!/usr/bin/python3
"""Meshes of one body in many rotations: the background is a lattice, and no lattice is alike in all directions.

    rotated.py [--rotations 30] [--seed 1] UMTET [CLOUD ...]

Two formulas (eq. (9) of the paper, and T6 of Section 4.1) and the clouds, each at the edge length of its first pose. A
line a body: exit codes, pieces and genus, and the least and the greatest of min Q, of the 1 % quantile of Q, and of the
distance of face centres (formulas) or of 99 % of the samples (clouds), in h.
"""
import argparse
import collections
import json
import os
import re
import subprocess
import tempfile

import numpy as np

from cloud_files import read_cloud

# The last term is 2e-5 at the ends of the body, and shuts out sheets beyond z = 1.5 that the box of the turned body would let in.
EQUATION_9 = ("2*y*(y^2-3*x^2)*(1-z^2)+(x^2+y^2)^2-(9*z^2-1)*(1-z^2)+exp(12*(z^2-1.9))", 2.6, ["--tets", "60000"])
T6 = ("+".join(f"32*{x}^6-48*{x}^4+18*{x}^2-1" for x in "xyz"), 2.1, ["--tets", "100000"])


def rotations(n, seed):
    """Uniform ones, from quaternions; the first is none."""
    random = np.random.default_rng(seed)
    yield np.eye(3)
    for _ in range(n - 1):
        a, b, c, d = (q := random.normal(size=4)) / np.linalg.norm(q)
        yield np.array([[a * a + b * b - c * c - d * d, 2 * (b * c - a * d), 2 * (b * d + a * c)],
                        [2 * (b * c + a * d), a * a - b * b + c * c - d * d, 2 * (c * d - a * b)],
                        [2 * (b * d - a * c), 2 * (c * d + a * b), a * a - b * b - c * c + d * d]])


def rotated_formula(formula, R):
    rows = dict(zip("xyz", (f"({r[0]:.17g}*x+({r[1]:.17g})*y+({r[2]:.17g})*z)" for r in R)))
    return re.sub(r"\b[xyz]\b", lambda m: rows[m.group()], formula)


def answer(umtet, *words):
    done = subprocess.run([umtet, *map(str, words), "--json", "--no-report", "--progress", "none"], stdout=subprocess.PIPE,
                          stderr=subprocess.DEVNULL, check=False)
    return done.returncode, json.loads(done.stdout).get("certificate")


def spread(values, digits=3):
    return f"{min(values):.{digits}f}–{max(values):.{digits}f}"


def table_line(name, results):
    codes = collections.Counter(code for code, _ in results)
    made = [c for _, c in results if c]
    shapes = sorted({(c["boundary"]["components"], c["boundary"]["genus"]) for c in made})
    off = [c["cloud"]["p99_distance_over_h"] if c["cloud"] else c["boundary"]["max_centroid_distance_over_h"] for c in made]
    print(f"| {name} | {', '.join(f'{code}: {n}' for code, n in sorted(codes.items()))} | {', '.join(f'{n}, genus {g}' for n, g in shapes)} | "
          f"{spread([c['n_tets'] / 1000 for c in made], 0)} k | {spread([c['quality']['min'] for c in made])} | "
          f"{spread([c['quality']['p01'] for c in made], 4)} | {spread(off)} |", flush=True)


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("umtet")
    parser.add_argument("clouds", nargs="*")
    parser.add_argument("--rotations", type=int, default=30)
    parser.add_argument("--seed", type=int, default=1)
    a = parser.parse_args()
    print("| body | exit code: poses | components | tets | min Q | 1 % of Q | distance, h |\n|---|---|---|---|---|---|---|")
    with tempfile.TemporaryDirectory() as folder:
        case = os.path.join(folder, "case")
        for name, (formula, half, size) in (("eq. (9)", EQUATION_9), ("T6", T6)):
            box = ",".join(map(str, [-half] * 3 + [half] * 3))
            results = []
            for R in rotations(a.rotations, a.seed):
                results.append(answer(a.umtet, "mesh", "--implicit", rotated_formula(formula, R), f"--box={box}", "-o", case,
                                      "--force", *size))
                if results[0][1]:
                    size = ["--h", repr(results[0][1]["h"])]
            table_line(name, results)
        for cloud in a.clouds:
            points, normals = read_cloud(cloud)
            results, size = [], []
            for R in rotations(a.rotations, a.seed):
                turned = os.path.join(folder, "turned.xyz")
                columns = points @ R.T if normals is None else np.hstack([points @ R.T, normals @ R.T])
                np.savetxt(turned, columns, fmt="%.17g")
                results.append(answer(a.umtet, "run", turned, "-o", case, "--force", *size))
                if results[0][1]:
                    size = ["--h", repr(results[0][1]["h"])]
            table_line(os.path.basename(cloud), results)


if __name__ == "__main__":
    main()
