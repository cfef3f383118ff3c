#!/usr/bin/python3
"""ellipsoid_cloud.py N: writes ellipsoid_N.ply, N points on a spiral around the ellipsoid 1 : .8 : .6, with exact normals.

For timings at any size (docs/performance.md). Needs Debian's python3-numpy.
"""
import sys

import numpy as np

n = int(sys.argv[1])
z = 1 - (2 * np.arange(n) + 1) / n
angle = 2.399963229728653 * np.arange(n)
sphere = np.c_[np.sqrt(1 - z * z) * np.cos(angle), np.sqrt(1 - z * z) * np.sin(angle), z]
axes = (1, .8, .6)
normals = sphere / axes
normals /= np.linalg.norm(normals, axis=1)[:, None]
with open(f"ellipsoid_{n}.ply", "wb") as file:
    properties = "".join(f"property double {name}\n" for name in ("x", "y", "z", "nx", "ny", "nz"))
    file.write(f"ply\nformat binary_little_endian 1.0\nelement vertex {n}\n{properties}end_header\n".encode())
    file.write(np.c_[sphere * axes, normals].tobytes())
