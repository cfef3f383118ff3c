#!/usr/bin/python3
"""What is true of a tet mesh of a known shape, whoever made it, as one JSON document.

usage: tests/bench/peers/measure.py MESH SHAPE [--h H]      any format that meshio reads; distances are divided by H
"""
import argparse
import json
from pathlib import Path

import meshio
import numpy as np

EDGES = ((0, 1), (0, 2), (0, 3), (1, 2), (1, 3), (2, 3))
FACES = ((1, 2, 3), (0, 3, 2), (0, 1, 3), (0, 2, 1))  # outward for a positive tet


def sphere(x):
    return (x**2).sum(1) - 1, 2 * x


def torus(x, R=1, r=.4):
    rho = np.hypot(x[:, 0], x[:, 1])
    s = 1 - R / rho
    return (rho - R)**2 + x[:, 2]**2 - r**2, 2 * np.c_[x[:, 0] * s, x[:, 1] * s, x[:, 2]]


def equation_9(p):
    x, y, z2 = p[:, 0], p[:, 1], p[:, 2]**2
    w, s, c = 1 - z2, x**2 + y**2, 2 * y * (y**2 - 3 * x**2)
    return c * w + s**2 - (9 * z2 - 1) * w, np.c_[-12 * x * y * w + 4 * x * s, 6 * (y**2 - x**2) * w + 4 * y * s,
                                                  2 * p[:, 2] * (18 * z2 - 10 - c)]


def banchoff_chmutov_6(x):
    a = x**2
    return (((32 * a - 48) * a + 18) * a - 1).sum(1), ((192 * a - 192) * a + 36) * x


def equation_13(x, t=3.2):
    return (x**2 + np.sin(t * x)).sum(1) - 1, 2 * x + t * np.cos(t * x)


SHAPES = {f.__name__: f for f in (sphere, torus, equation_9, banchoff_chmutov_6, equation_13)}


def mean_ratio(P):
    """Q of eq. (6); P: tets x 4 corners x 3."""
    a, b, c = P[:, 1] - P[:, 0], P[:, 2] - P[:, 0], P[:, 3] - P[:, 0]
    mu = np.einsum("ij,ij->i", np.cross(a, b), c) / 6
    l2 = sum(((P[:, j] - P[:, i])**2).sum(1) for i, j in EDGES)
    return 12 * np.cbrt(9) * np.cbrt(mu)**2 * np.sign(mu) / l2


def dihedral_angles(P):
    """Degrees, tets x 6. A flat tet has angles of 0 and 180, one without area has NaN."""
    n = [np.cross(P[:, j] - P[:, i], P[:, k] - P[:, i]) for i, j, k in FACES]
    with np.errstate(invalid="ignore", divide="ignore"):
        n = [v / np.linalg.norm(v, axis=1)[:, None] for v in n]
    cos = [-np.einsum("ij,ij->i", n[i], n[j]) for i, j in EDGES]
    return np.degrees(np.arccos(np.clip(np.stack(cos, 1), -1, 1)))


def boundary(tets):
    """Faces of one tet only."""
    faces = np.concatenate([tets[:, f] for f in FACES])
    a, b, c = np.sort(faces.astype(np.int64), 1).T
    n = tets.max() + 1  # below two million vertices n^3 fits
    if n >= 2**21:
        raise ValueError(f"{n} vertices: too many for the numbers that faces get here")
    _, first, count = np.unique((a * n + b) * n + c, return_index=True, return_counts=True)
    return faces[first[count == 1]]


def pieces(faces):
    from scipy.sparse import coo_matrix
    from scipy.sparse.csgraph import connected_components
    used, f = np.unique(faces, return_inverse=True)
    f = f.reshape(-1, 3)
    graph = coo_matrix((np.ones(2 * len(f)), (np.r_[f[:, 0], f[:, 1]], np.r_[f[:, 1], f[:, 2]])), (len(used),) * 2)
    return int(connected_components(graph, directed=False)[0])


def distance(psi, x, steps=20):
    """|t| of y = x + t grad psi(y) / |grad psi(y)|, psi(y) = 0, as in Section 3.8(a); NaN where it does not settle."""
    y, t = x.copy(), np.zeros(len(x))
    for _ in range(steps):
        f, g = psi(y)
        norm = np.linalg.norm(g, axis=1)
        step = f / norm
        t -= step
        y = x + t[:, None] * g / norm[:, None]
    return np.where(np.abs(step) <= 1e-6 * np.abs(t) + 1e-12, np.abs(t), np.nan)


def measure(points, tets, psi, h):
    P = points[tets]
    if np.median(mean_ratio(P)) < 0:  # some tools number the corners the other way round
        tets = tets[:, [1, 0, 2, 3]]
        P = points[tets]
    Q, angles, skin = mean_ratio(P), dihedral_angles(P), boundary(tets)
    at_vertices = distance(psi, points[np.unique(skin)]) / h
    at_centroids = distance(psi, points[skin].mean(1)) / h
    return {
        "tets": len(tets), "boundary_faces": len(skin), "pieces": pieces(skin), "inverted": int((Q <= 0).sum()),
        "min_Q": Q.min(), "p01_Q": np.quantile(Q, .01), "mean_Q": Q.mean(),
        "dihedral_min": np.nanmin(angles), "dihedral_max": np.nanmax(angles),
        "vertex_distance": np.nanmax(at_vertices), "centroid_distance": np.nanmax(at_centroids),
        "centroid_distance_rms": np.sqrt(np.nanmean(at_centroids**2)),
        "unprojected": int(np.isnan(at_vertices).sum() + np.isnan(at_centroids).sum()),
        "Q_histogram": np.histogram(Q, 200, (0, 1))[0].tolist(),
        "angle_histogram": np.histogram(angles, 180, (0, 180))[0].tolist(),
    }


def read(path):
    """Points in double and tets. MEDIT of version 1 is read here: meshio would round its points to single."""
    if path.endswith(".mesh"):
        text = Path(path).read_text()

        def rows(word, columns):
            count, data = text[text.index(word) + len(word):].split(maxsplit=1)
            return np.fromstring(data, sep=" ", count=int(count) * columns).reshape(-1, columns)[:, :-1]

        return rows("\nVertices", 4), rows("\nTetrahedra", 5).astype(np.int64) - 1
    mesh = meshio.read(path)
    tets = [block.data for block in mesh.cells if block.type == "tetra"]
    return mesh.points.astype(float), np.concatenate(tets).astype(np.int64)


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("mesh")
    parser.add_argument("shape", choices=SHAPES)
    parser.add_argument("--h", type=float, default=1)
    args = parser.parse_args()
    print(json.dumps(measure(*read(args.mesh), SHAPES[args.shape], args.h)))


if __name__ == "__main__":
    main()
