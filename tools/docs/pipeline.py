#!/usr/bin/python3
"""Draws docs/pipeline.svg, the steps from samples to a mesh: samples, psi, the chosen tets, the mesh and a cut through it.

usage: tools/docs/pipeline.py [--umtet build/release/pipeline/umtet] [--data build/figures]
Makes the case `pipeline` in the data folder if it is not there. Needs Debian's python3-vtk9.
"""
import argparse
import subprocess
from pathlib import Path

import numpy as np
from vtkmodules.util.numpy_support import vtk_to_numpy
from vtkmodules.vtkCommonDataModel import vtkPlane
from vtkmodules.vtkFiltersCore import vtkContourFilter, vtkCutter, vtkStripper
from vtkmodules.vtkIOPLY import vtkPLYReader
from vtkmodules.vtkIOXML import vtkXMLImageDataReader

from mesh_svg import UNIT, Mesh, Page, axes_of_view

ROOT = Path(__file__).resolve().parents[2]
SAND, BLUE, GREEN = (245, 205, 130), (150, 190, 235), (160, 215, 160)
PANEL, HEIGHT, SCALE = 150, 130, 70  # points of the page; points a model unit
CAPTIONS = ("samples with normals", "level set psi", "chosen tets omega_h", "mesh on psi = 0", "the mesh cut open")


def samples(page, path, view, at):
    """The samples that face the eye, as dots."""
    reader = vtkPLYReader()
    reader.SetFileName(str(path))
    reader.Update()
    data = reader.GetOutput()
    points, normals = (vtk_to_numpy(a).astype(float) for a in (data.GetPoints().GetData(), data.GetPointData().GetNormals()))
    x, towards = points @ view.T, normals @ view[2]
    for k in np.argsort(x[:, 2]):
        if towards[k] > 0:
            grey = int(170 - 150 * towards[k])
            u, v = np.round(UNIT * (np.asarray(at) + SCALE * x[k, :2] * [1, -1])).astype(int)
            page.parts.append(f'<circle cx="{u}" cy="{v}" r="6" fill="rgb({grey},{grey},{grey})"/>')


def level_set(page, path, at):
    """Lines of equal psi in the plane z = 0, psi = 0 bold."""
    reader = vtkXMLImageDataReader()
    reader.SetFileName(str(path))
    plane, cut = vtkPlane(), vtkCutter()
    plane.SetNormal(0, 0, 1)
    cut.SetCutFunction(plane)
    cut.SetInputConnection(reader.GetOutputPort())
    for value in np.arange(-.2, .11, .1):
        lines, strips = vtkContourFilter(), vtkStripper()
        lines.SetInputConnection(cut.GetOutputPort())
        lines.SetInputArrayToProcess(0, 0, 0, 0, "psi")
        lines.SetValue(0, value)
        strips.SetInputConnection(lines.GetOutputPort())
        strips.SetMaximumLength(100000)
        strips.Update()
        drawn = strips.GetOutput()
        if not drawn.GetNumberOfLines():
            continue
        x = vtk_to_numpy(drawn.GetPoints().GetData())[:, :2]
        zero = abs(value) < 1e-9
        colour, width = ("#1d2b3a", 14) if zero else ("#7fa7d8", 6) if value < 0 else ("#d8a97f", 6)
        cells, ends = (vtk_to_numpy(a) for a in (drawn.GetLines().GetConnectivityArray(), drawn.GetLines().GetOffsetsArray()))
        for begin, end in zip(ends[:-1], ends[1:]):
            flat = np.round(UNIT * (np.asarray(at) + SCALE * x[cells[begin:end]] * [1, -1])).astype(int)
            page.parts.append(f'<polyline fill="none" stroke="{colour}" stroke-width="{width}" points="'
                              + " ".join(f"{u},{v}" for u, v in flat.tolist()) + '"/>')


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--umtet", type=Path, default=ROOT / "build/release/pipeline/umtet")
    parser.add_argument("--data", type=Path, default=ROOT / "build/figures")
    arguments = parser.parse_args()
    case = arguments.data / "pipeline"
    if not (case / "5-view/psi.vti").exists():
        arguments.data.mkdir(parents=True, exist_ok=True)
        subprocess.run([arguments.umtet, "run", ROOT / "data/clouds/duck.ply", "-o", case, "--tets", "12000", "--no-report", "--progress", "none"],
                       check=True, stdout=subprocess.DEVNULL)
        subprocess.run([arguments.umtet, "view", case, "--progress", "none"], check=True, stdout=subprocess.DEVNULL)
    turn = np.array([[1, 0, 0], [0, 0, -1], [0, 1, 0]], float)  # the duck's y is up
    view = axes_of_view(-65, 15) @ turn
    page = Page(PANEL * 5, HEIGHT)
    at = [(PANEL * (k + .5), 75) for k in range(5)]
    for (x, _), caption in zip(at, CAPTIONS):
        page.text(x, 14, caption)
    samples(page, case / "1-cloud/cloud.ply", view, at[0])
    level_set(page, case / "5-view/psi.vti", at[1])
    chosen, mesh = Mesh(case / "3-mesh/omega_h.vtu"), Mesh(case / "3-mesh/mesh.vtu")
    page.mesh(chosen.points, chosen.boundary(), SAND, view, np.zeros(3), SCALE, at[2], line=.15)
    page.mesh(mesh.points, mesh.boundary(), BLUE, view, np.zeros(3), SCALE, at[3], line=.15)
    faces, fresh = mesh.cut((0, 0, 1))
    page.mesh(mesh.points, faces, np.where(fresh[:, None], GREEN, BLUE), view, np.zeros(3), SCALE, at[4], line=.15)
    page.save(ROOT / "docs/pipeline.svg")


if __name__ == "__main__":
    main()
