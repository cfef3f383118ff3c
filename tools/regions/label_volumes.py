#!/usr/bin/python3
"""Meshes of all labels of segmentations: label_volumes.py UMTET [--n=VOXELS] [--keep=FOLDER] [NAME ...]

Makes segmentations of N voxels along each axis, meshes all labels of each by `umtet regions`, and prints for each label
the volume in the mesh against that of its voxels, the pieces and the least Q.
"""
import json
import pathlib
import resource
import subprocess
import sys
import tempfile

import numpy as np


def coordinates(n):
    axis = (np.arange(n) + .5) / n * 2 - 1
    return np.meshgrid(axis, axis, axis, indexing="ij")


def tube(x, y, z, points, radius):
    """Whether a voxel is within a radius of a polyline."""
    inside = np.zeros(x.shape, bool)
    for a, b in zip(points[:-1], points[1:]):
        a, b = np.array(a), np.array(b)
        d = b - a
        t = np.clip(((x - a[0]) * d[0] + (y - a[1]) * d[1] + (z - a[2]) * d[2]) / (d @ d), 0, 1)
        inside |= (x - a[0] - t * d[0])**2 + (y - a[1] - t * d[1])**2 + (z - a[2] - t * d[2])**2 < radius**2
    return inside


def head(n):
    """Skin, skull, fluid, a folded sheet around a core, and vessels three voxels across."""
    x, y, z = coordinates(n)
    r = np.sqrt((x / .78)**2 + (y / .9)**2 + (z / .82)**2)
    label = np.zeros(x.shape, np.uint8)
    label[r < 1] = 1
    label[r < .88] = 2
    label[r < .76] = 3
    fold = .6 + .06 * np.sin(9 * x + 2) * np.sin(8 * y) * np.sin(9 * z + 1)
    label[r < fold] = 4
    label[r < fold - .16] = 5
    pitch = 2 / n
    spiral = [(.45 * np.cos(t), .5 * np.sin(t), .3 * t / 3 - .3) for t in np.linspace(0, 6, 40)]
    label[tube(x, y, z, spiral, 1.5 * pitch)] = 6
    label[tube(x, y, z, [(0, 0, -.4), (0, 0, .2), (.2, .1, .42)], 1.5 * pitch)] = 6
    return label, {1: "skin", 2: "skull", 3: "fluid", 4: "grey", 5: "white", 6: "vessels"}


def knee(n):
    """Three bones that touch, with cartilage between two of them, in soft tissue."""
    x, y, z = coordinates(n)
    label = np.zeros(x.shape, np.uint8)
    label[(x / .8)**2 + (y / .8)**2 + (z / .95)**2 < 1] = 1
    femur = (x / .42)**2 + (y / .42)**2 + ((z - .42) / .4)**2 < 1
    tibia = (x / .45)**2 + (y / .42)**2 + ((z + .45) / .4)**2 < 1
    cartilage = ((x / .3)**2 + (y / .3)**2 < 1) & (abs(z) < .09) & ~femur & ~tibia
    patella = (x / .16)**2 + ((y - .5) / .13)**2 + ((z - .25) / .22)**2 < 1
    label[cartilage] = 4
    label[femur] = 2
    label[tibia] = 3
    label[patella & ~femur] = 5
    return label, {1: "tissue", 2: "femur", 3: "tibia", 4: "cartilage", 5: "patella"}


def cut_ball(n):
    """A ball in two halves: two sheets are one sphere where they meet the third."""
    x, y, z = coordinates(n)
    label = np.zeros(x.shape, np.uint8)
    inside = x**2 + y**2 + z**2 < .5
    label[inside] = 1
    label[inside & (.8 * x + .6 * y + .1 * z > .02)] = 2
    return label, {1: "lower", 2: "upper"}


def bubbles(n):
    """Two balls that meet in a flat disc."""
    x, y, z = coordinates(n)
    a, b = (x - .3)**2 + (y - .1)**2 + z**2, (x + .3)**2 + (y + .1)**2 + z**2
    label = np.zeros(x.shape, np.uint8)
    label[(a < .25) & (a <= b)] = 1
    label[(b < .25) & (b < a)] = 2
    return label, {1: "right", 2: "left"}


VOLUMES = {"head": head, "knee": knee, "cut ball": cut_ball, "double bubble": bubbles}


def write(path, label):
    n = label.shape
    with open(path, "wb") as out:
        out.write(f"NRRD0004\ntype: uint8\ndimension: 3\nsizes: {n[0]} {n[1]} {n[2]}\nspacings: 1 1 1\n"
                  "encoding: raw\n\n".encode())
        out.write(label.tobytes(order="F"))


def main():
    umtet = sys.argv[1]
    options = dict(a[2:].split("=") for a in sys.argv[2:] if a.startswith("--"))
    names = [a for a in sys.argv[2:] if not a.startswith("--")] or list(VOLUMES)
    print("| volume | label | voxels | tets | volume in the mesh | pieces | least Q |\n|---|---|---|---|---|---|---|")
    with tempfile.TemporaryDirectory() as temporary:
        folder = pathlib.Path(options.get("keep", temporary))
        folder.mkdir(exist_ok=True, parents=True)
        for name in names:
            label, labels = VOLUMES[name](int(options.get("n", 96)))
            file, out = folder / f"{name.replace(' ', '_')}.nrrd", folder / name.replace(" ", "_")
            write(file, label)
            before = resource.getrusage(resource.RUSAGE_CHILDREN)
            words = [umtet, "regions", str(file), "--label-names", ",".join(f"{k}={v}" for k, v in labels.items()),
                     "--threads", options.get("threads", "1"), "-o", str(out), "-q"]
            if "h" in options:
                words += ["--h", options["h"]]
            done = subprocess.run(words, capture_output=True, text=True, check=False)
            after = resource.getrusage(resource.RUSAGE_CHILDREN)
            if done.returncode not in (0, 6):
                print(f"{name}: {done.stderr.strip()}", file=sys.stderr)
                continue
            found = json.loads((out / "regions.json").read_text())
            voxels = {v["region"]: v for v in found["voxels"]}
            seconds = after.ru_utime + after.ru_stime - before.ru_utime - before.ru_stime
            print(f"| {name} | all: {found['verdict']} in {seconds:.0f} CPU s, {len(found['defects'])} defects | | "
                  f"{found['n_tets']:,} | | | {found['quality']['min']:.3f} |")
            for r in found["regions"]:
                v = voxels.get(r["name"])
                change = f"{100 * (v['volume'] / v['volume_of_voxels'] - 1):+.2f} %" if v else ""
                pieces = f"{r['pieces']} of {v['pieces_by_points']}" if v else r["pieces"]
                print(f"| | {r['name']} | {v['voxels'] if v else ''} | {r['n_tets']:,} | {change} | {pieces} | "
                      f"{r['quality']['min']:.3f} |")
            for reason in found["reasons"]:
                print(f"{name}: {reason}", file=sys.stderr)


if __name__ == "__main__":
    main()
