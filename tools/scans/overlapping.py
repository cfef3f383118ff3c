#!/usr/bin/python3
"""Two scans that do not quite fit: the second one sees a third of the body, and lies beside the first. Prints what
umtet makes of the two sheets.

usage: overlapping.py UMTET [BODY ...] [--points=20000] [--keep=FOLDER]

Bodies are ball, torus, eq_9, duck and PATH.ply, a mesh that is closed; ball, eq_9 and duck if none is named. A
spacing is the root of area over points. The second scan is moved along x by as many spacings as the table says, or
turned about the z axis until the farthest of its points has moved by 2. Distances, in spacings, and angles, in
degrees, are those of the mesh where x is greatest, the overlap, to the body of the first scan. Places are those that
the certificate calls too thin.
"""
import os
import sys
import tempfile

import numpy as np

import bodies
import triangle_mesh
from case import boundary, certified, reason, rms_angle, run, shown
from cloud_files import write_ply

OFFSETS = (0, .5, 1, 1.5, 2, "turned")


def moved(points, normals, offset, spacing):
    """A scan where its registration put it."""
    if offset != "turned":
        return points + [offset * spacing, 0, 0], normals
    middle = (points.min(0) + points.max(0)) / 2
    angle = 2 * spacing / np.linalg.norm((points - middle)[:, :2], axis=1).max()
    turn = np.array([[np.cos(angle), -np.sin(angle), 0], [np.sin(angle), np.cos(angle), 0], [0, 0, 1]])
    return middle + (points - middle) @ turn.T, normals @ turn.T


def measured(umtet, body, case, spacing, edge):
    """Distances and angle in the overlap, x > edge."""
    mesh = boundary(umtet, case)
    if mesh is None:
        return np.nan, np.nan, np.nan
    x = triangle_mesh.corners(mesh)[0]
    distance = body.distance(x[x[:, 0] > edge]) / spacing
    return distance.mean(), np.quantile(distance, .99), rms_angle(body, mesh, lambda x: x[:, 0] > edge)


def main():
    options = dict(a[2:].split("=", 1) for a in sys.argv[1:] if a.startswith("--"))
    umtet, *names = [a for a in sys.argv[1:] if not a.startswith("--")]
    n = int(options.get("points", 20_000))
    print("body       offset exit genus right pieces  min Q   mean   99 %  angle places  CPU s")
    with tempfile.TemporaryDirectory() as temporary:
        folder = options.get("keep", temporary)
        os.makedirs(folder, exist_ok=True)
        for body in map(bodies.body, names or ["ball", "eq_9", "duck"]):
            spacing = (triangle_mesh.area(body.mesh) / n)**.5
            first, second = body.sample(n, 3), body.sample(n, 4)
            edge = np.quantile(first[0][:, 0], 2 / 3)
            seen = second[0][:, 0] > edge
            for offset in OFFSETS:
                points, normals = moved(second[0][seen], second[1][seen], offset, spacing)
                case = os.path.join(folder, f"{body.name}_{offset}")
                write_ply(case + ".ply", np.vstack([first[0], points]), np.vstack([first[1], normals]))
                done = run(umtet, case + ".ply", case)
                mean, most, angle = measured(umtet, body, case, spacing, edge)
                thin = certified(case, "resolution", "too_thin")
                print(f"{body.name:10.10} {offset:>6} {done.code:4}", shown(certified(case, "boundary", "genus"), 5),
                      shown(body.genus, 5), shown(certified(case, "boundary", "components"), 6),
                      shown(certified(case, "quality", "min"), 6, ".3f"), shown(mean, 6, ".3f"), shown(most, 6, ".3f"),
                      shown(angle, 6, ".2f"), shown(None if thin is None else len(thin), 6), shown(done.cpu, 6, ".1f"),
                      reason(done, case), flush=True)


if __name__ == "__main__":
    main()
