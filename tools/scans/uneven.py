#!/usr/bin/python3
"""Clouds that are sampled unevenly: scan lines 1, 3, 10, 30 times denser along than across, and a density that falls
by 100 from one side to the other. Prints what umtet makes of them.

usage: uneven.py UMTET [BODY ...] [--gap=.02] [--normals=estimate] [--scans=LINES,fall,...] [--noise=0] [--h=EDGE]
                 [--keep=FOLDER]

Bodies are ball, torus, eq_9, duck and PATH.ply, a mesh that is closed (ARMADILLO=PATH.ply adds one). Lines lie in
parallel planes `gap` diagonals apart, those across x where |n_x| <= .75, else those across y. Noise is along normals,
in gaps. Distances and angles are those of the mesh's vertices and faces to the body, not to the samples. --h takes a
finer mesh, which sees finer ripples of psi.
"""
import os
import sys
import tempfile

import numpy as np
import vtk
from vtk.util.numpy_support import vtk_to_numpy

import bodies
import triangle_mesh
from case import boundary, certified, number, rms_angle, run
from cloud_files import write_ply

STEEPEST = .75  # of a slice: |n . axis| of the surface it cuts


def slices(mesh, axis, gap, step):
    """Points `step` apart on the polylines in planes `gap` apart, and the mesh's normals there."""
    low, high = np.array(mesh.GetBounds()).reshape(3, 2)[axis]
    plane = vtk.vtkPlane()
    plane.SetNormal(*np.eye(3)[axis])
    cutter = vtk.vtkCutter()
    cutter.SetInputData(mesh)
    cutter.SetCutFunction(plane)
    for k, at in enumerate(np.arange(low + .371 * gap, high, gap)):
        cutter.SetValue(k, at)
    stripper = vtk.vtkStripper()
    stripper.SetInputConnection(cutter.GetOutputPort())
    stripper.SetMaximumLength(1_000_000)
    stripper.JoinContiguousSegmentsOn()
    stripper.Update()
    lines = stripper.GetOutput()
    x = vtk_to_numpy(lines.GetPoints().GetData()).astype(float)
    normals = lines.GetPointData().GetNormals()
    m = vtk_to_numpy(normals).astype(float) if normals else np.zeros_like(x)
    random = np.random.default_rng(axis)
    points, ids = [], vtk.vtkIdList()
    lines.GetLines().InitTraversal()
    while lines.GetLines().GetNextCell(ids):
        line = [ids.GetId(k) for k in range(ids.GetNumberOfIds())]
        t = np.concatenate([[0], np.cumsum(np.linalg.norm(np.diff(x[line], axis=0), axis=1))])
        s = np.arange(random.random() * step, t[-1], step)
        points.append(np.stack([np.interp(s, t, q[line, d]) for q in (x, m) for d in range(3)], 1))
    points = np.concatenate(points)
    return points[:, :3], points[:, 3:]


def scan_lines(body, gap, ratio):
    mesh = body.mesh
    points, normals = [], []
    for axis in (0, 1):
        x, n = body.on_surface(*slices(mesh, axis, gap, gap / ratio))
        here = np.abs(n[:, 0]) <= STEEPEST if axis == 0 else np.abs(n[:, 0]) > STEEPEST
        points.append(x[here])
        normals.append(n[here])
    return np.concatenate(points), np.concatenate(normals)


def falling(body, gap, fall=100):
    """As many points as squares of gap, fall times as dense on the left as on the right."""
    mesh = body.mesh
    low, high = mesh.GetBounds()[:2]
    n = int(20 * triangle_mesh.area(mesh) / gap**2)
    return body.on_surface(*triangle_mesh.random_points(mesh, n, lambda p: fall**(-(p[:, 0] - low) / (high - low)), 1))


def measure(body, mesh):
    """rms and 99 % of the vertices' distances, rms angle of the faces."""
    x = triangle_mesh.corners(mesh)[0]
    distance = np.linalg.norm(x - body.foot(x)[0], axis=1)
    return np.sqrt(np.mean(distance**2)), np.quantile(distance, .99), rms_angle(body, mesh)


def main():
    options = dict(a[2:].split("=", 1) for a in sys.argv[1:] if a.startswith("--"))
    umtet, *names = [a for a in sys.argv[1:] if not a.startswith("--")]
    if not names:
        names = ["ball", "torus", "eq_9"] + [os.environ[k] for k in ["ARMADILLO"] if k in os.environ]
    gap_over_diagonal = float(options.get("gap", .02))
    scans = options.get("scans", "1,3,10,30,fall").split(",")
    print(f"{'body':10} {'scan':>5} {'points':>7} exit genus  min Q  {'rms':>8} {'99 %':>8} angle "
          f"{'h':>8} {'lattice':>8} {'gap':>8} {'tets':>8} {'CPU s':>6}   (rms, 99 % in gaps; angle in degrees)")
    with tempfile.TemporaryDirectory() as temporary:
        folder = options.get("keep", temporary)
        os.makedirs(folder, exist_ok=True)
        for name in names:
            body = bodies.body(name)
            gap = gap_over_diagonal * body.diagonal()
            for scan in scans:
                points, normals = falling(body, gap) if scan == "fall" else scan_lines(body, gap, float(scan))
                noise = np.random.default_rng(7).standard_normal((len(points), 1))
                points = points + float(options.get("noise", 0)) * gap * noise * normals
                case = os.path.join(folder, f"{body.name}_{scan}")
                write_ply(case + ".ply", points, None if options.get("normals") == "estimate" else normals)
                done = run(umtet, case + ".ply", case, ["--h", options["h"]] if "h" in options else [])
                row = f"{body.name:10} {scan:>5} {len(points):7} {done.code:4} "
                mesh = boundary(umtet, case)
                if mesh is None:
                    print(row + f"{'':66}{done.cpu:6.1f}  {done.error()[:150]}", flush=True)
                    continue
                rms, most, angle = measure(body, mesh)
                print(row + f"{certified(case, 'boundary', 'genus')!s:>5} {certified(case, 'quality', 'min'):6.3f} "
                      f"{rms / gap:9.4f} {most / gap:8.4f} {angle:5.2f} {certified(case, 'h'):8.4f} "
                      f"{number(case, '2-level-set/record.json', 'numbers', 'spacing'):8.4f} {gap:8.4f} "
                      f"{certified(case, 'n_tets'):8} {done.cpu:6.1f}", flush=True)


if __name__ == "__main__":
    main()
