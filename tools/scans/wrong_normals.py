#!/usr/bin/python3
"""What umtet makes of normals that are wrong, noisy or missing.

usage: wrong_normals.py UMTET SOURCES [--only WORD] [--bodies NAME,...] [--reference DIR] [FILE ...]

Clouds are made from a ball, a torus, the clouds of SOURCES/data/clouds and the given files (.ply or .xyz). A file
without normals is run as it is; its true normals are those of DIR/<its name>, a mesh, where there is one.
One line a cloud: share of normals on the wrong side, and rms angle, after the preparation; exit; genus and the true
one.
"""
import argparse
import os
import re
import sys
import tempfile

import numpy as np
from scipy.spatial import cKDTree

import triangle_mesh
from bodies import random_ball
from case import certified, run
from cloud_files import read_cloud, read_ply, reference_of, write_ply

GENUS = {"ball": 0, "torus": 1, "bird": 0, "blob_nonuniform": 0, "duck": 1, "knot": 7, "torus_hole_noise": 1,
         "armadillo": 0, "blub": 0, "cat_no_normals": 0, "koala": 0, "penguin_flipped_normals": 0, "scorpion": 0,
         "skull": 2, "spot_ascii": 0, "spot_large": 0, "berger_daratech": 7, "berger_daratech_noise": 7,
         "berger_dc_noise": 8, "vipss_bottle": 0, "vipss_hand_ok_sparse": 1, "walrus": 0}


def mesh_truth(file, points):
    """Normals of the nearest of a mesh's face samples."""
    places, normals = triangle_mesh.random_points(triangle_mesh.read(file), 400000, lambda x: np.ones(len(x)), 1)
    nearest = normals[cKDTree(places).query(points)[1]]
    return nearest / np.linalg.norm(nearest, axis=1)[:, None]


def spread(points, n):
    """n of the points, each farthest from those before."""
    chosen = [0]
    distance = np.linalg.norm(points - points[0], axis=1)
    for _ in range(n - 1):
        chosen.append(int(distance.argmax()))
        distance = np.minimum(distance, np.linalg.norm(points - points[chosen[-1]], axis=1))
    return np.array(chosen)


def torus(random, n):
    """That of bodies.py by other draws: the results on record are of these clouds."""
    u, v, w = random.random((3, 10 * n))
    keep = (1 + .4 * np.cos(2 * np.pi * v) > 1.4 * w).nonzero()[0][:n]
    u, v = 2 * np.pi * u[keep], 2 * np.pi * v[keep]
    normals = np.stack([np.cos(u) * np.cos(v), np.sin(u) * np.cos(v), np.sin(v)], 1)
    return np.stack([np.cos(u), np.sin(u), 0 * u], 1) + .4 * normals, normals


def plate(spacings, n, random):
    """A plate of one by one, as many spacings thick, samples jittered on a grid."""
    s = (2 / n) ** .5
    thick = spacings * s
    points, normals = [], []
    for axis, size in ((2, (1, 1)), (0, (1, thick)), (1, (thick, 1))):
        counts = [max(1, round(a / s)) for a in size]
        for side in (-1, 1):
            grid = np.stack(np.meshgrid(*[(np.arange(c) + .5) / c for c in counts]), -1).reshape(-1, 2)
            grid = (grid + random.uniform(-.3, .3, grid.shape) / counts) * size
            x = np.zeros((len(grid), 3))
            x[:, (axis + 1) % 3], x[:, (axis + 2) % 3] = grid.T
            x[:, axis] = (thick if axis == 2 else 1) * (side > 0)
            points.append(x)
            normals.append(np.tile(side * np.eye(3)[axis], (len(x), 1)))
    return np.vstack(points), np.vstack(normals)


def turned_patches(points, normals, share, random):
    turned = np.zeros(len(points), bool)
    size = max(1, int(share / 4 * len(points)))
    tree = cKDTree(points)
    while turned.sum() < share * len(points) * .99:
        left = int(share * len(points)) - turned.sum()
        turned[np.atleast_1d(tree.query(points[random.integers(len(points))], min(size, max(1, left)))[1])] = True
    return np.where(turned[:, None], -normals, normals)


def noisy(normals, degrees, random):
    """Turned about random axes by angles of this standard deviation."""
    axis = np.cross(normals, random.normal(size=normals.shape))
    axis /= np.maximum(np.linalg.norm(axis, axis=1), 1e-300)[:, None]
    angle = np.radians(degrees) * random.normal(size=(len(normals), 1))
    return np.cos(angle) * normals + np.sin(angle) * np.cross(axis, normals)


def cases(name, points, normals):
    random = np.random.default_rng(1)
    yield "given", points, normals, normals
    yield "10 % turned, scattered", points, np.where(random.random((len(points), 1)) < .1, -normals, normals), normals
    yield "10 % turned, patches", points, turned_patches(points, normals, .1, random), normals
    yield "30 degrees of noise", points, noisy(normals, 30, random), normals
    yield "a third missing", points, np.where(random.random((len(points), 1)) < 1 / 3, 0, normals), normals
    yield "all of these", points, noisy(np.where(random.random((len(points), 1)) < 1 / 3, 0, turned_patches(
        points, np.where(random.random((len(points), 1)) < .05, -normals, normals), .05, random)), 15, random), normals
    yield "none", points, None, normals
    for n in (50, 200, 1000, 5000):
        if name in ("ball", "torus"):
            many = (random_ball if name == "ball" else torus)(random, 6 * n)
        else:
            many = points, normals
        if n <= len(many[0]):
            few = spread(many[0], n)
            yield "none, %d points" % n, many[0][few], None, many[1][few]


def bodies(sources, files, reference):
    random = np.random.default_rng(2)
    for name, make in (("ball", random_ball), ("torus", torus)):
        points, normals = make(random, 8000)
        yield from ((name, *case) for case in cases(name, points, normals))
    folder = os.path.join(sources, "data/clouds")
    for name in sorted(os.listdir(folder)):
        points, normals = read_cloud(os.path.join(folder, name))
        yield from ((name[:-4], *case) for case in cases(name[:-4], points, normals))
    for spacings in (3, 2, 1):
        points, normals = plate(spacings, 5000, random)
        yield "plate", "none, %d spacings" % spacings, points, None, normals
        turned = np.where(random.random((len(points), 1)) < .1, -normals, normals)
        yield "plate", "10 %% turned, %d spacings" % spacings, points, turned, normals
    for file in files:
        name = os.path.splitext(os.path.basename(file))[0]
        points, normals = read_cloud(file)
        truth = None if normals is None else normals / np.maximum(np.linalg.norm(normals, axis=1), 1e-300)[:, None]
        mesh = reference_of(file, [reference] if reference else [])
        if mesh:
            truth = mesh_truth(mesh, points)
        yield name, "as it is", points, normals, truth


def measured(umtet, points, normals, truth, folder):
    cloud, case = os.path.join(folder, "cloud.ply"), os.path.join(folder, "case")
    write_ply(cloud, points, normals)
    done = run(umtet, cloud, case)
    wrong = angle = kept = float("nan")
    prepared = os.path.join(case, "1-cloud/cloud.ply")
    if os.path.exists(prepared):
        x, n = read_ply(prepared)[:2]
        kept = len(x)
        if truth is not None:
            cosine = (n * truth[cKDTree(points).query(x)[1]]).sum(1)
            wrong = 100 * np.mean(cosine <= 0)
            angle = np.degrees(np.sqrt(np.mean(np.arccos(np.clip(np.abs(cosine), 0, 1)) ** 2)))
    said = re.findall(r"turned \d+[^\n]*", done.stderr)
    return kept, wrong, angle, done.code, certified(case, "boundary", "genus"), done.cpu, "; ".join(said)[:90]


def main():
    parser = argparse.ArgumentParser(usage=__doc__.split("\n\n", maxsplit=2)[1])
    parser.add_argument("umtet")
    parser.add_argument("sources")
    parser.add_argument("files", nargs="*")
    parser.add_argument("--only", default="")
    parser.add_argument("--bodies", default="")
    parser.add_argument("--reference", default="")
    given = parser.parse_intermixed_args()
    print("%-24s %-26s %6s %7s %6s %4s %6s %4s %6s" % ("body", "normals", "points", "wrong %", "angle", "exit", "genus",
                                                       "true", "CPU s"))
    with tempfile.TemporaryDirectory() as folder:
        for name, kind, points, normals, truth in bodies(given.sources, given.files, given.reference):
            if given.only not in kind or (given.bodies and name not in given.bodies.split(",")):
                continue
            kept, wrong, angle, status, genus, seconds, said = measured(given.umtet, points, normals, truth, folder)
            print("%-24s %-26s %6s %7.2f %6.1f %4d %6s %4s %6.2f  %s" % (
                name, kind, kept, wrong, angle, status, genus, GENUS.get(name, 0 if name == "plate" else "-"), seconds,
                said), flush=True)


if __name__ == "__main__":
    sys.exit(main())
