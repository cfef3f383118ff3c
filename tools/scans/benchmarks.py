#!/usr/bin/python3
"""Every cloud of some folders by default flags: one row of Markdown each.

usage: benchmarks.py UMTET FOLDER ... [--poisson=PROGRAM] [--timeout=150]

Clouds are .ply, .xyz and .pcd; the truth is FOLDER/reference/<name>.ply where there is one (reference_of). PROGRAM is
that of cgal_poisson.cpp, for the same columns. Distances are in 1e-4 of the diagonal of the truth, mean / 99 %: "to"
is from the vertices of the mesh to the truth, "from" is from points of the truth to the mesh. Exit 124 is more
seconds than the timeout.
"""
import pathlib
import sys
import tempfile

import numpy as np

from bodies import Mesh
from case import boundary, both_distances, certified, poisson, reason, run, shown
from cloud_files import SUFFIXES, read_cloud, reference_of, write_ply
from triangle_mesh import pieces_and_genus


def distance_cells(truth, mesh):
    if truth is None or mesh is None:
        return ["-", "-"]
    return [f"{1e4 * d.mean():.2f} / {1e4 * np.quantile(d, .99):.2f}" for d in both_distances(truth, mesh)]


def our_cells(umtet, file, truth, folder, timeout):
    case = folder / "case"
    done = run(umtet, file, case, timeout=timeout)
    mesh = boundary(umtet, case)
    cells = [str(done.code), shown(certified(case, "boundary", "genus"), 0),
             shown(certified(case, "quality", "min"), 0, ".3f"), shown(certified(case, "n_tets"), 0), f"{done.cpu:.1f}",
             shown(certified(case, "cloud", "noise_over_h"), 0, ".3f"), *distance_cells(truth, mesh)]
    return cells, reason(done, case)


def their_cells(program, file, truth, folder, timeout):
    """Of CGAL's Poisson; it reads PLY only."""
    if file.suffix != ".ply":
        write_ply(folder / "cloud.ply", *read_cloud(file))
        file = folder / "cloud.ply"
    done, mesh = poisson(program, file, folder / "poisson.ply", timeout)
    genus = pieces_and_genus(mesh)[1] if mesh else None
    return [str(done.code), shown(genus, 0), f"{done.cpu:.1f}", *distance_cells(truth, mesh)]


def main():
    options = dict(a[2:].split("=", 1) for a in sys.argv[1:] if a.startswith("--"))
    umtet, *folders = [a for a in sys.argv[1:] if not a.startswith("--")]
    program, timeout = options.get("poisson"), float(options.get("timeout", 150))
    header = ["cloud", "exit", "genus", "min Q", "tets", "CPU s", "noise/h", "to", "from"]
    header += ["CGAL: exit", "genus", "CPU s", "to", "from"] if program else []
    print("|", " | ".join(header), "|\n" + "|---" * len(header) + "|", flush=True)
    with tempfile.TemporaryDirectory() as temporary:
        work = pathlib.Path(temporary)
        for file in (f for folder in folders for f in sorted(pathlib.Path(folder).iterdir()) if f.suffix in SUFFIXES):
            reference = reference_of(file)
            truth = Mesh(reference) if reference else None
            cells, error = our_cells(umtet, file, truth, work, timeout)
            cells += their_cells(program, file, truth, work, timeout) if program else []
            print("|", " | ".join([file.stem, *cells]), "|", error, flush=True)


if __name__ == "__main__":
    main()
