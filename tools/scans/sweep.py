#!/usr/bin/python3
"""Every file of a folder and of the folders in it, by default flags: one row each.

usage: sweep.py UMTET FOLDER OUT [--timeout=150] [--flags='--tets 50000'] [--again]

Clouds, triangles and images are run into cases of their own below OUT. Rows go to OUT/sweep.csv and sweep.md as they are
made; rows that are there are kept, but with --again. Volume, genus, pieces, bodies and least Q are measured of the mesh
file. Where the file holds triangles, "volume off" is in percent of the volume that they enclose, with plane fans over
their rims; their genus is empty where they are open. Seconds are of CPU; exit 124 is more than the timeout.
"""
import pathlib
import shlex
import shutil
import sys

import numpy as np

import tet_mesh
import triangle_mesh
from case import IMAGES, TIMEOUT, certified, reason, run_first, words_for
from judging import measured_case
from results import Rows, shown

COLUMNS = ["file", "exit", "verdict", "seconds", "tets", "least Q", "volume", "volume off", "genus", "genus of input",
           "pieces", "bodies", "reason"]
POINTS = (".ply", ".xyz", ".pcd", ".asc", ".csv", ".pts", ".npts", ".xyzn", ".xyzrgb", ".off")
SUFFIXES = (*triangle_mesh.READERS, *POINTS, *IMAGES)


def files_below(folder):
    folder = pathlib.Path(folder)
    return [f for f in sorted(folder.rglob("*")) if f.is_file() and f.name.lower().endswith(SUFFIXES)]


def truth(file):
    """(volume, genus) of the triangles in a file; None each where there are none, for the genus where they are open."""
    if file.suffix.lower() not in triangle_mesh.READERS:
        return None, None
    mesh = triangle_mesh.joined(triangle_mesh.read(file))
    if mesh.GetNumberOfPolys() == 0:
        return None, None
    points, faces = triangle_mesh.corners(mesh)
    genus = tet_mesh.surface(faces).genus
    return abs(tet_mesh.enclosed_volume(*tet_mesh.closed_flat(points, faces))), genus


def row_of(umtet, file, key, case, flags, timeout):
    done = run_first(umtet, words_for(file), [flags], case, timeout)
    m = measured_case(case) if done.code != TIMEOUT else None
    volume, genus = truth(file)
    off = 100 * (m.volume / volume - 1) if m and volume else None
    return dict(zip(COLUMNS, [
        key, done.code, certified(case, "verdict") or "", shown(done.cpu, ".1f"), m.tets if m else "",
        shown(m and m.least_q, ".3f"), shown(m and m.volume, ".5g"), shown(off, "+.2f"), shown(m and m.genus),
        shown(genus), shown(m and m.pieces), shown(m and m.bodies), reason(done, case)]))


def summary(rows):
    rows = list(rows)
    if not rows:
        return "no file"
    seconds = np.array([float(row["seconds"]) for row in rows])
    passed = sum(row["exit"] == "0" for row in rows)
    far = sum(abs(float(row["volume off"])) > 3 for row in rows if row["volume off"])
    genus = sum(row["genus"] != row["genus of input"] for row in rows if row["genus"] and row["genus of input"])
    return (f"{passed} of {len(rows)} exit 0; median {np.median(seconds):.1f} s, {int((seconds > 15).sum())} over 15 s; "
            f"volume off by more than 3 % in {far}, another genus than the triangles in {genus}")


def main():
    options = dict((a[2:].split("=", 1) + [""])[:2] for a in sys.argv[1:] if a.startswith("--"))
    umtet, folder, out = [a for a in sys.argv[1:] if not a.startswith("--")]
    out = pathlib.Path(out)
    table = Rows(out / "sweep.csv", COLUMNS)
    for file in files_below(folder):
        key = str(file.relative_to(folder))
        if key in table and "again" not in options:
            continue
        case = out / "case"
        row = row_of(umtet, file, key, case, shlex.split(options.get("flags", "")), float(options.get("timeout", 150)))
        table.add(row)
        print("|", " | ".join(str(row[k]) for k in COLUMNS), "|", flush=True)
        shutil.rmtree(case, ignore_errors=True)
    out.mkdir(parents=True, exist_ok=True)
    (out / "sweep.md").write_text(table.markdown() + "\n" + summary(table) + "\n", encoding="utf8")
    print(summary(table))


if __name__ == "__main__":
    main()
