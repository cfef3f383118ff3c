#!/usr/bin/python3
"""Meshes of random bodies, judged by programs of others: VTK measures the tets and the boundary, TetGen looks for faces
of the boundary that intersect. The certificate has to agree with them.

usage: peers.py UMTET [BODIES] [SEED]

A body is where a sum of some Gaussians exceeds a level: blobs with necks, handles and pieces. BODIES (20) of them, from
SEED (1) on, each with 10,000 to 60,000 tets of one size or graded. The exit code is 1 if a judge disagrees. A mesh that
umtet itself does not pass is a row, and no failure: the judges look at it all the same.
"""
import json
import os
import re
import subprocess
import sys
import tempfile

import numpy as np
import vtk
from vtk.util.numpy_support import vtk_to_numpy

TOLERANCE = 1e-9  # both sides compute in double


def formula(random):
    centres = random.uniform(-1, 1, (random.integers(2, 8), 3))
    terms = [f"exp(-((x-({x:.6f}))^2+(y-({y:.6f}))^2+(z-({z:.6f}))^2)/{w * w:.6f})"
             for (x, y, z), w in zip(centres, random.uniform(.3, .8, len(centres)))]
    return f"{random.uniform(.35, .6):.6f}-({'+'.join(terms)})"


def quality(grid, measure):
    judge = vtk.vtkMeshQuality()
    judge.SetInputData(grid)
    judge.SetTetQualityMeasure(measure)
    judge.Update()
    return vtk_to_numpy(judge.GetOutput().GetCellData().GetArray("Quality"))


def boundary(grid):
    """Corners and triangles of the boundary, and its number of edges that are not between two triangles."""
    surface = vtk.vtkGeometryFilter()
    surface.SetInputData(grid)
    surface.Update()
    faces = surface.GetOutput()
    edges = vtk.vtkFeatureEdges()
    edges.SetInputData(faces)
    edges.FeatureEdgesOff()
    edges.ManifoldEdgesOff()
    edges.Update()
    triangles = vtk_to_numpy(faces.GetPolys().GetConnectivityArray()).reshape(-1, 3)
    return vtk_to_numpy(faces.GetPoints().GetData()), triangles, edges.GetOutput().GetNumberOfCells()


def intersects(points, triangles, folder):
    """Whether TetGen finds triangles that intersect; its words, if it says neither."""
    with open(os.path.join(folder, "skin.off"), "w", encoding="ascii") as f:
        f.write(f"OFF\n{len(points)} {len(triangles)} 0\n")
        np.savetxt(f, points, "%.17g")
        np.savetxt(f, np.column_stack([np.full(len(triangles), 3), triangles]), "%d")
    said = subprocess.run(["tetgen", "-d", "skin.off"], cwd=folder, capture_output=True, text=True, check=False).stdout
    if re.search(r"^No faces are intersecting", said, re.M):
        return False
    return True if re.search(r"\d+ pairs? .*intersect|faces? .*intersect", said) else said[-300:]


def disagreements(case, folder):
    with open(os.path.join(case, "certificate.json"), encoding="utf8") as f:
        certificate = json.load(f)
    reader = vtk.vtkXMLUnstructuredGridReader()
    reader.SetFileName(os.path.join(case, "3-mesh", "mesh.vtu"))
    reader.Update()
    grid = reader.GetOutput()
    volumes = quality(grid, vtk.VTK_QUALITY_VOLUME)
    least = 1 / quality(grid, vtk.VTK_QUALITY_ASPECT_FROBENIUS).max()  # the mean ratio is its inverse
    points, triangles, n_open = boundary(grid)
    b = certificate["boundary"]
    found = []
    if grid.GetNumberOfCells() != certificate["n_tets"]:
        found.append(f"{grid.GetNumberOfCells()} tets by VTK, {certificate['n_tets']} by umtet")
    if (volumes <= 0).sum() != certificate["quality"]["n_inverted"]:
        found.append(f"{(volumes <= 0).sum()} inverted tets by VTK, {certificate['quality']['n_inverted']} by umtet")
    if abs(volumes.sum() / certificate["volume"] - 1) > TOLERANCE:
        found.append(f"volume {volumes.sum()} by VTK, {certificate['volume']} by umtet")
    if abs(least - certificate["quality"]["min"]) > TOLERANCE:
        found.append(f"least Q {least} by VTK, {certificate['quality']['min']} by umtet")
    if len(triangles) != b["n_faces"]:
        found.append(f"{len(triangles)} faces by VTK, {b['n_faces']} by umtet")
    if (n_open == 0) != b["closed_manifold"]:
        found.append(f"{n_open} open or branching edges by VTK, closed_manifold {b['closed_manifold']} by umtet")
    meets = intersects(points, triangles, folder)
    if meets is not (b["self_intersections"] > 0):
        found.append(f"intersecting faces by TetGen: {meets}, by umtet: {b['self_intersections']}")
    return certificate, found


def main():
    umtet = sys.argv[1]
    n, seed = (int(a) for a in (sys.argv[2:] + ["20", "1"][len(sys.argv) - 2:])[:2])
    wrong = 0
    for k in range(seed, seed + n):
        random = np.random.default_rng(k)
        body, tets = formula(random), int(random.uniform(1e4, 6e4))
        sizes = ["--background", "graded"] if random.integers(2) else []
        with tempfile.TemporaryDirectory() as folder:
            case = os.path.join(folder, "case")
            command = [umtet, "mesh", "--implicit", body, "--box=-3,-3,-3,3,3,3", "--tets", str(tets), *sizes, "-o", case,
                       "--no-report", "--progress", "none", "-q"]
            done = subprocess.run(command, capture_output=True, text=True, check=False)
            if not os.path.exists(os.path.join(case, "certificate.json")):
                print(f"{k}: exit {done.returncode}, no mesh: {done.stderr.strip()}")
                wrong += done.returncode not in (5, 6)
                continue
            certificate, found = disagreements(case, folder)
        wrong += bool(found)
        print(f"{k}: exit {done.returncode}, {certificate['n_tets']} tets, least Q {certificate['quality']['min']:.3f}, "
              f"{certificate['boundary']['components']} pieces of the boundary: {'; '.join(found) or 'all agree'}")
    print(f"{n - wrong} of {n} bodies: all judges agree")
    return 1 if wrong else 0


if __name__ == "__main__":
    sys.exit(main())
