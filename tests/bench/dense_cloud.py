#!/usr/bin/python3
"""dense_cloud.py N [NOISE]: writes dense_N.ply, N random points of a torus and of a ball in its hole, with normals.

Far more points than any mesh shows, for timings and memory (docs/performance.md): 24 bytes a point, so a hundred million
are 2.4 GB. NOISE is a standard deviation along the normal, in units of the torus (R = 1, r = .35; the ball has .4);
.0005 unless it is given. Points are made and written a million at a time. Needs Debian's python3-numpy.
"""
import sys

import numpy as np

BLOCK = 1_000_000
R, r, BALL = 1, .35, .4
AREA_TORUS, AREA_BALL = 4 * np.pi**2 * R * r, 4 * np.pi * BALL**2


def torus(random, n):
    """Uniform by area: of 2 n angles around the tube those are kept that its circumference there asks for."""
    v = np.empty(0)
    while len(v) < n:
        more = 2 * np.pi * random.random(2 * n)
        v = np.r_[v, more[random.random(2 * n) * (R + r) < R + r * np.cos(more)]]
    v, u = v[:n], 2 * np.pi * random.random(n)
    normals = np.c_[np.cos(u) * np.cos(v), np.sin(u) * np.cos(v), np.sin(v)]
    return np.c_[R * np.cos(u), R * np.sin(u), np.zeros(n)] + r * normals, normals


def ball(random, n):
    normals = random.standard_normal((n, 3))
    normals /= np.linalg.norm(normals, axis=1)[:, None]
    return BALL * normals, normals


n, noise = int(sys.argv[1]), float(sys.argv[2]) if len(sys.argv) > 2 else .0005
random = np.random.default_rng(1)
with open(f"dense_{n}.ply", "wb") as file:
    properties = "".join(f"property float {name}\n" for name in ("x", "y", "z", "nx", "ny", "nz"))
    file.write(f"ply\nformat binary_little_endian 1.0\nelement vertex {n}\n{properties}end_header\n".encode())
    for begin in range(0, n, BLOCK):
        n_block = min(BLOCK, n - begin)
        n_ball = round(n_block * AREA_BALL / (AREA_BALL + AREA_TORUS))
        points, normals = map(np.concatenate, zip(torus(random, n_block - n_ball), ball(random, n_ball)))
        points = points + noise * random.standard_normal(n_block)[:, None] * normals
        block = np.c_[points, normals][random.permutation(n_block)]
        file.write(block.astype("<f4").tobytes())
