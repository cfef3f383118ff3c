#!/usr/bin/env python3
"""Scans of whole bodies with parts left out, and what umtet makes of them: the tables of docs/incomplete.md.

usage: scans.py UMTET FOLDER [--bodies ball,torus,...] [--cuts slab,cone,...] [--more "FLAGS"]

Bodies: ball, torus, bracket (drawn here), duck, bird (data/clouds), armadillo (the file ARMADILLO names, if it does).
Each is cut four ways: a slab off one side, a cone of view from the middle, discs at random places, and what one, two or
five scanners do not see (hidden point removal). Writes FOLDER/BODY_CUT.ply, FOLDER/table.csv and prints the
table: volume against that of the whole body, genus, pieces, exit code.
"""
import argparse
import csv
import json
import os
import pathlib
import subprocess
import sys

import numpy as np
from scipy.spatial import ConvexHull, cKDTree

REPOSITORY = pathlib.Path(__file__).resolve().parents[2]


def read_ply(path):
    data = pathlib.Path(path).read_bytes()
    end = data.index(b"end_header\n") + len(b"end_header\n")
    header = data[:end].decode().splitlines()
    n = next(int(line.split()[2]) for line in header if line.startswith("element vertex"))
    fields = [line.split()[1:] for line in header if line.startswith("property") and "list" not in line]
    dtype = {"float": "<f4", "float32": "<f4", "double": "<f8", "float64": "<f8", "int": "<i4", "uchar": "u1"}
    if "format ascii" in data[:60].decode():
        table = np.array(data[end:].split()[: n * len(fields)], float).reshape(n, len(fields))
    else:
        rows = np.frombuffer(data[end:], [(name, dtype[kind]) for kind, name in fields], n)
        table = np.stack([rows[name].astype(float) for _, name in fields], 1)
    names = [name for _, name in fields]
    column = {name: i for i, name in enumerate(names)}
    return (table[:, [column[c] for c in ("x", "y", "z")]], table[:, [column[c] for c in ("nx", "ny", "nz")]])


def write_ply(path, points, normals=None):
    names = ["x", "y", "z"] + (["nx", "ny", "nz"] if normals is not None else [])
    header = "ply\nformat binary_little_endian 1.0\nelement vertex %d\n%send_header\n" % (
        len(points), "".join("property float %s\n" % name for name in names))
    table = points if normals is None else np.hstack([points, normals])
    pathlib.Path(path).write_bytes(header.encode() + table.astype("<f4").tobytes())


def ball(random, n=20000):
    x = random.normal(size=(n, 3))
    x /= np.linalg.norm(x, axis=1)[:, None]
    return x, x.copy()


def torus(random, n=30000, major=1.0, minor=0.4):
    v = random.uniform(0, 2 * np.pi, 4 * n)
    v = v[random.uniform(0, 1, 4 * n) < (major + minor * np.cos(v)) / (major + minor)][:n]
    u = random.uniform(0, 2 * np.pi, len(v))
    normal = np.stack([np.cos(v) * np.cos(u), np.cos(v) * np.sin(u), np.sin(v)], 1)
    return major * np.stack([np.cos(u), np.sin(u), 0 * u], 1) + minor * normal, normal


def bracket(random, n=40000):
    """Two arms, a post and an eye: genus 1, concave between the arms."""

    def capsule(x, a, b, r):
        t = np.clip((x - a) @ (b - a) / np.dot(b - a, b - a), 0, 1)
        return np.linalg.norm(x - a - t[:, None] * (b - a), axis=1) - r

    def eye(x):
        y = x - np.array([0, 0, 1.55])
        return np.hypot(np.hypot(y[:, 0], y[:, 2]) - 0.4, y[:, 1]) - 0.17

    def f(x):
        p = [np.array(v, float) for v in ([0, 0, -1], [0, 0, 1.15], [1, 0, 0], [-1, 0, 0])]
        parts = [capsule(x, p[0], p[1], 0.28), capsule(x, p[0], p[2], 0.24), capsule(x, p[0], p[3], 0.24), eye(x)]
        return -0.05 * np.log(sum(np.exp(-q / 0.05) for q in parts))

    def gradient(x, step=1e-5):
        return np.stack([(f(x + step * e) - f(x - step * e)) / (2 * step) for e in np.eye(3)], 1)

    x = random.uniform([-1.4, -0.5, -1.4], [1.4, 0.5, 2.2], (40 * n, 3))
    x = x[np.abs(f(x)) < 0.03]  # a layer of equal thickness: equal density once projected
    for _ in range(6):
        g = gradient(x)
        x -= (f(x) / np.einsum("ij,ij->i", g, g))[:, None] * g
    keep = random.permutation(len(x))[:n]
    g = gradient(x[keep])
    return x[keep], g / np.linalg.norm(g, axis=1)[:, None]


def bodies():
    known = {shape.__name__: lambda shape=shape: shape(np.random.default_rng(1)) for shape in (ball, torus, bracket)}
    for name in ("duck", "bird"):
        known[name] = lambda name=name: read_ply(REPOSITORY / "data" / "clouds" / (name + ".ply"))
    if os.environ.get("ARMADILLO"):
        known["armadillo"] = lambda: read_ply(os.environ["ARMADILLO"])
    return known


def tilted(random):
    d = random.normal(size=3)
    return d / np.linalg.norm(d)


def seen_from(x, eye):
    """Which points a scanner at `eye` sees: hidden point removal [Katz, Tal & Basri 2007]."""
    v = x - eye
    r = np.linalg.norm(v, axis=1)
    flipped = v + 2 * (100 * r.max() - r)[:, None] * v / r[:, None]
    seen = np.zeros(len(x), bool)
    vertices = ConvexHull(np.vstack([flipped, np.zeros(3)])).vertices
    seen[vertices[vertices < len(x)]] = True
    return seen


def cuts(x, normals, random):
    """(name, share removed or None, mask of what is kept)"""
    centre, size = (x.min(0) + x.max(0)) / 2, np.linalg.norm(np.ptp(x, axis=0))
    for axis, d in (("down", np.array([0, 0, -1.0])), ("tilted", tilted(random))):
        for share in (10, 25, 40):
            height = (x - centre) @ d
            yield "slab_%s_%d" % (axis, share), share, height < np.quantile(height, 1 - share / 100)
    d = tilted(random)
    angle = ((x - centre) @ d) / np.linalg.norm(x - centre, axis=1)
    for share in (10, 25, 40):
        yield "cone_%d" % share, share, angle < np.quantile(angle, 1 - share / 100)
    tree = cKDTree(x)
    for share in (10, 25, 40):
        keep = np.ones(len(x), bool)
        while keep.mean() > 1 - share / 100:
            keep[tree.query_ball_point(x[random.integers(len(x))], random.uniform(0.02, 0.12) * size)] = False
        yield "holes_%d" % share, share, keep
    for scanners in (1, 2, 5):
        keep = np.zeros(len(x), bool)
        for k in range(scanners):
            azimuth = 2 * np.pi * (k + 0.3) / scanners
            eye = centre + 2 * size * np.array([np.cos(azimuth), np.sin(azimuth), 0.35])
            keep |= seen_from(x, eye)
        yield "scanners_%d" % scanners, round(100 * (1 - keep.mean())), keep


def run(umtet, cloud, folder, flags):
    (folder / "certificate.json").unlink(missing_ok=True)
    done = subprocess.run([umtet, "run", str(cloud), "-o", str(folder), "--force", "--progress", "none", *flags],
                          stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True)
    result = {"exit": done.returncode, "error": done.stderr.strip().splitlines()[-1:] or [""]}
    try:
        certificate = json.loads((folder / "certificate.json").read_text())
        boundary = certificate["boundary"]
        result.update(volume=certificate["volume"], genus=boundary["genus"], pieces=boundary["components"])
    except (OSError, KeyError, ValueError):
        pass
    return result


def main():
    parser = argparse.ArgumentParser()
    parser.add_argument("umtet")
    parser.add_argument("folder", type=pathlib.Path)
    parser.add_argument("--bodies", default="")
    parser.add_argument("--cuts", default="")
    parser.add_argument("--more", default="")
    a = parser.parse_args()
    a.folder.mkdir(parents=True, exist_ok=True)
    table = []
    for body, make in bodies().items():
        if a.bodies and body not in a.bodies.split(","):
            continue
        random = np.random.default_rng(2)
        x, normals = make()
        write_ply(a.folder / (body + ".ply"), x, normals)
        whole = run(a.umtet, a.folder / (body + ".ply"), a.folder / body, a.more.split())
        print(body, whole, flush=True)
        for cut, share, keep in cuts(x, normals, random):
            if a.cuts and not any(cut.startswith(c) for c in a.cuts.split(",")):
                continue
            name = "%s_%s" % (body, cut)
            write_ply(a.folder / (name + ".ply"), x[keep], normals[keep])
            r = run(a.umtet, a.folder / (name + ".ply"), a.folder / name, a.more.split())
            off = 100 * (r["volume"] / whole["volume"] - 1) if "volume" in r else float("nan")
            right = r.get("genus") == whole.get("genus") and r.get("pieces") == whole.get("pieces")
            table.append([body, cut, share, r["exit"], off, r.get("genus"), r.get("pieces"), right])
            print("%-10s %-15s %3d %% removed: exit %d, volume %+6.2f %%, genus %s, pieces %s%s %s" % (
                body, cut, share, r["exit"], off, r.get("genus"), r.get("pieces"), "" if right else "  WRONG",
                r["error"][0][:150] if r["exit"] else ""), flush=True)
    with open(a.folder / "table.csv", "w", newline="") as f:
        writer = csv.writer(f)
        writer.writerow(["body", "cut", "removed", "exit", "volume", "genus", "pieces", "right"])
        writer.writerows(table)
    for low, high in ((1, 15), (15, 32), (32, 90)):
        of = [r for r in table if low <= r[2] < high]
        off = np.abs([r[4] for r in of])
        if len(of):
            print("%d to %d %% removed: %d clouds, exit 0: %d, right genus and pieces: %d, volume off by %.2f %% median, %.2f %% worst" % (
                low, high, len(of), sum(r[3] == 0 for r in of), sum(r[7] for r in of), np.nanmedian(off), np.nanmax(off)))


if __name__ == "__main__":
    sys.exit(main())
