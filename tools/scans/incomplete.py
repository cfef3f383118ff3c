#!/usr/bin/python3
"""Scans of whole bodies with parts left out, and what umtet makes of them: the tables of docs/incomplete.md.

usage: incomplete.py UMTET FOLDER [--bodies ball,torus,...] [--cuts slab,cone,...] [--more "FLAGS"]

Bodies: ball, torus, bracket (drawn here), duck, bird (data/clouds), armadillo (the file ARMADILLO names, if it does).
Each is cut four ways: a slab off one side, a cone of view from the middle, discs at random places, and what one, two or
five scanners do not see (hidden point removal). Writes FOLDER/BODY_CUT.ply, FOLDER/table.csv and prints the
table: volume against that of the whole body, genus, pieces, exit code.
"""
import argparse
import csv
import os
import pathlib
import sys

import numpy as np
from scipy.spatial import ConvexHull, cKDTree

from bodies import cloud, random_ball, random_bracket, random_torus
from case import certified, run
from cloud_files import read_cloud, write_ply

def bodies():
    known = {"ball": lambda: random_ball(np.random.default_rng(1), 20000),
             "torus": lambda: random_torus(np.random.default_rng(1), 30000),
             "bracket": lambda: random_bracket(np.random.default_rng(1), 40000),
             "duck": lambda: cloud("duck"), "bird": lambda: cloud("bird")}
    if os.environ.get("ARMADILLO"):
        known["armadillo"] = lambda: read_cloud(os.environ["ARMADILLO"])
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


def made(umtet, file, folder, flags):
    """What umtet makes of a cloud."""
    done = run(umtet, file, folder, flags)
    return {"exit": done.code, "error": done.error(), "volume": certified(folder, "volume"),
            "genus": certified(folder, "boundary", "genus"), "pieces": certified(folder, "boundary", "components")}


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
        write_ply(a.folder / (body + ".ply"), x, normals, "float")
        whole = made(a.umtet, a.folder / (body + ".ply"), a.folder / body, a.more.split())
        print(body, whole, flush=True)
        for cut, share, keep in cuts(x, normals, random):
            if a.cuts and not any(cut.startswith(c) for c in a.cuts.split(",")):
                continue
            name = "%s_%s" % (body, cut)
            write_ply(a.folder / (name + ".ply"), x[keep], normals[keep], "float")
            r = made(a.umtet, a.folder / (name + ".ply"), a.folder / name, a.more.split())
            off = 100 * (r["volume"] / whole["volume"] - 1) if r["volume"] and whole["volume"] else float("nan")
            right = (r["genus"], r["pieces"]) == (whole["genus"], whole["pieces"])
            table.append([body, cut, share, r["exit"], off, r["genus"], r["pieces"], right])
            print("%-10s %-15s %3d %% removed: exit %d, volume %+6.2f %%, genus %s, pieces %s%s %s" % (
                body, cut, share, r["exit"], off, r["genus"], r["pieces"], "" if right else "  WRONG",
                r["error"][:150] if r["exit"] else ""), flush=True)
    with open(a.folder / "table.csv", "w", newline="") as f:
        writer = csv.writer(f)
        writer.writerow(["body", "cut", "removed", "exit", "volume", "genus", "pieces", "right"])
        writer.writerows(table)
    for low, high in ((1, 15), (15, 32), (32, 90)):
        of = [r for r in table if low <= r[2] < high]
        off = np.abs([r[4] for r in of])
        if of:
            print("%d to %d %% removed: %d clouds, exit 0: %d, right genus and pieces: %d," % (
                low, high, len(of), sum(r[3] == 0 for r in of), sum(r[7] for r in of)),
                "volume off by %.2f %% median, %.2f %% worst" % (np.nanmedian(off), np.nanmax(off)))


if __name__ == "__main__":
    sys.exit(main())
