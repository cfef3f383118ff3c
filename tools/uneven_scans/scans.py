#!/usr/bin/python3
"""Clouds that are sampled unevenly: scan lines 1, 3, 10, 30 times denser along than across, and a density that falls by
100 from one side to the other. Prints what umtet makes of them.

usage: scans.py UMTET [BODY ...] [--gap=.02] [--normals=estimate] [--scans=LINES,fall,...] [--noise=0] [--h=EDGE] [--keep=FOLDER]

Bodies are ball, torus, eq_9 and PATH.ply, a mesh that is closed (ARMADILLO=PATH.ply adds one). Lines lie in parallel planes
`gap` diagonals apart, those across x where |n_x| <= .75, else those across y. Noise is along normals, in gaps. Distances and angles are those of the
mesh's vertices and faces to the body, not to the samples. --h takes a finer mesh, which sees finer ripples of psi.
"""
import json
import os
import subprocess
import sys
import tempfile

import numpy as np
import vtk
from scipy.spatial import cKDTree
from vtk.util.numpy_support import numpy_to_vtk, vtk_to_numpy

STEEPEST = .75  # of a slice: |n . axis| of the surface it cuts
GRID = 160  # of the triangles that implicit bodies are sampled from


class Implicit:
    def __init__(self, name, half_box, f, gradient, genus):
        self.name, self.half_box, self.f, self.gradient, self.genus = name, np.array(half_box), f, gradient, genus

    def triangles(self):
        axes = [np.linspace(-b, b, GRID) for b in self.half_box]
        grid = np.stack(np.meshgrid(*axes, indexing="ij"), -1)
        image = vtk.vtkImageData()
        image.SetDimensions(GRID, GRID, GRID)
        image.SetOrigin(*-self.half_box)
        image.SetSpacing(*(2 * self.half_box / (GRID - 1)))
        image.GetPointData().SetScalars(numpy_to_vtk(self.f(grid).ravel(order="F"), deep=True))
        contour = vtk.vtkFlyingEdges3D()
        contour.SetInputData(image)
        contour.SetValue(0, 0)
        contour.Update()
        return contour.GetOutput()

    def foot(self, x):
        """Closest points and normals, for points near the surface."""
        y = x.copy()
        for _ in range(20):
            g = self.gradient(y)
            g2 = np.sum(g * g, 1, keepdims=True)
            tangential = (x - y) - np.sum((x - y) * g, 1, keepdims=True) / g2 * g
            y = y - self.f(y)[:, None] / g2 * g + .5 * tangential
        for _ in range(3):
            g = self.gradient(y)
            y = y - self.f(y)[:, None] / np.sum(g * g, 1, keepdims=True) * g
        g = self.gradient(y)
        return y, g / np.linalg.norm(g, axis=1, keepdims=True)

    def on_surface(self, x, normals):
        return self.foot(x)


class Mesh:
    def __init__(self, path):
        self.name, self.genus = os.path.splitext(os.path.basename(path))[0], None
        reader = vtk.vtkPLYReader()
        reader.SetFileName(path)
        normals = vtk.vtkPolyDataNormals()
        normals.SetInputConnection(reader.GetOutputPort())
        normals.SplittingOff()
        normals.ConsistencyOn()
        normals.AutoOrientNormalsOn()
        normals.Update()
        self.mesh = normals.GetOutput()
        self.dense = random_points(self.mesh, 1_000_000, lambda x: np.ones(len(x)), 5)
        self.tree = cKDTree(self.dense[0])

    def triangles(self):
        return self.mesh

    def foot(self, x):
        _, nearest = self.tree.query(x)
        p, n = self.dense[0][nearest], self.dense[1][nearest]
        return x - np.sum((x - p) * n, 1, keepdims=True) * n, n

    def on_surface(self, x, normals):
        return x, normals / np.linalg.norm(normals, axis=1, keepdims=True)


def eq_9():
    def f(p):
        x, y, z = p[..., 0], p[..., 1], p[..., 2]
        return 2 * y * (y * y - 3 * x * x) * (1 - z * z) + (x * x + y * y)**2 - (9 * z * z - 1) * (1 - z * z)

    def gradient(p):
        x, y, z = p[:, 0], p[:, 1], p[:, 2]
        w, s, c = 1 - z * z, x * x + y * y, 2 * y * (y * y - 3 * x * x)
        return np.stack([-12 * x * y * w + 4 * x * s, 6 * (y * y - x * x) * w + 4 * y * s,
                         2 * z * (18 * z * z - 10 - c)], 1)

    return Implicit("eq_9", [2.1, 2.1, 1.05], f, gradient, 2)


def torus(R=1, r=.4):
    def gradient(p):
        s = 1 - R / np.hypot(p[:, 0], p[:, 1])
        return 2 * np.stack([p[:, 0] * s, p[:, 1] * s, p[:, 2]], 1)

    return Implicit("torus", [R + r + .1, R + r + .1, r + .1],
                    lambda p: (np.hypot(p[..., 0], p[..., 1]) - R)**2 + p[..., 2]**2 - r * r, gradient, 1)


def ball():
    return Implicit("ball", [1.1] * 3, lambda p: np.sum(p * p, -1) - 1, lambda p: 2 * p, 0)


def corners(mesh):
    points = vtk_to_numpy(mesh.GetPoints().GetData()).astype(float)
    faces = vtk_to_numpy(mesh.GetPolys().GetConnectivityArray()).reshape(-1, 3)
    return points, faces


def random_points(mesh, n, density, seed):
    """White noise: about n points, as many per area as density says; and the normals of the mesh's vertices between."""
    random = np.random.default_rng(seed)
    x, faces = corners(mesh)
    a, b, c = (x[faces[:, k]] for k in range(3))
    cross = np.cross(b - a, c - a)
    weight = np.linalg.norm(cross, axis=1) * density((a + b + c) / 3)
    face = random.choice(len(faces), n, p=weight / weight.sum())
    u, v = random.random((2, n))
    outside = u + v > 1
    u[outside], v[outside] = 1 - u[outside], 1 - v[outside]
    points = a[face] + u[:, None] * (b - a)[face] + v[:, None] * (c - a)[face]
    if mesh.GetPointData().GetNormals() is None:
        return points, cross[face]
    m = vtk_to_numpy(mesh.GetPointData().GetNormals()).astype(float)
    at = [m[faces[face, k]] for k in range(3)]
    n = at[0] + u[:, None] * (at[1] - at[0]) + v[:, None] * (at[2] - at[0])
    return points, n / np.linalg.norm(n, axis=1, keepdims=True)


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
    mesh = body.triangles()
    points, normals = [], []
    for axis in (0, 1):
        x, n = body.on_surface(*slices(mesh, axis, gap, gap / ratio))
        here = np.abs(n[:, 0]) <= STEEPEST if axis == 0 else np.abs(n[:, 0]) > STEEPEST
        points.append(x[here])
        normals.append(n[here])
    return np.concatenate(points), np.concatenate(normals)


def falling(body, gap, fall=100):
    """As many points as squares of gap, fall times as dense on the left as on the right."""
    mesh = body.triangles()
    low, high = mesh.GetBounds()[:2]
    x, faces = corners(mesh)
    area = np.linalg.norm(np.cross(x[faces[:, 1]] - x[faces[:, 0]], x[faces[:, 2]] - x[faces[:, 0]]), axis=1).sum() / 2
    n = int(20 * area / gap**2)
    return body.on_surface(*random_points(mesh, n, lambda p: fall**(-(p[:, 0] - low) / (high - low)), 1))


def write_ply(path, points, normals):
    columns = points if normals is None else np.hstack([points, normals])
    names = ["x", "y", "z", "nx", "ny", "nz"][:columns.shape[1]]
    with open(path, "wb") as file:
        file.write((f"ply\nformat binary_little_endian 1.0\nelement vertex {len(columns)}\n" +
                    "".join(f"property double {name}\n" for name in names) + "end_header\n").encode())
        file.write(np.ascontiguousarray(columns, "<f8").tobytes())


def read_surface(path):
    reader = vtk.vtkPLYReader()
    reader.SetFileName(path)
    reader.Update()
    return corners(reader.GetOutput())


def run(umtet, source, case, more):
    before = os.times()
    code = subprocess.run([umtet, "run", source, "-o", case, "--no-report", "--progress", "none", "-q"] + more,
                          stdout=subprocess.DEVNULL, stderr=subprocess.PIPE, check=False)
    after = os.times()
    cpu = after.children_user + after.children_system - before.children_user - before.children_system
    return code.returncode, cpu, code.stderr.decode().strip()


def numbers(case, *keys):
    try:
        with open(os.path.join(case, *keys[:1]), encoding="utf8") as file:
            value = json.load(file)
        for key in keys[1:]:
            value = value[key]
        return value
    except (FileNotFoundError, KeyError):
        return None


def measure(umtet, body, case):
    """rms and 99 % of the vertices' distances, rms angle of the faces."""
    subprocess.run([umtet, "export", case, "--format", "ply", "-q"], check=True, stdout=subprocess.DEVNULL)
    x, faces = read_surface(os.path.join(case, "4-export", "mesh.ply"))
    a, b, c = (x[faces[:, k]] for k in range(3))
    cross = np.cross(b - a, c - a)
    area = np.linalg.norm(cross, axis=1)
    y, _ = body.foot(x)
    distance = np.linalg.norm(x - y, axis=1)
    _, n = body.foot((a + b + c) / 3)
    cosine = np.clip(np.sum(cross * n, 1) / area, -1, 1)
    angle = np.degrees(np.arccos(cosine))
    return (np.sqrt(np.mean(distance**2)), np.quantile(distance, .99), np.sqrt(np.sum(area * angle**2) / np.sum(area)))


def main():
    options = dict(a[2:].split("=", 1) for a in sys.argv[1:] if a.startswith("--"))
    umtet, *names = [a for a in sys.argv[1:] if not a.startswith("--")]
    known = {"ball": ball, "torus": torus, "eq_9": eq_9}
    if not names:
        names = list(known) + [os.environ[k] for k in ["ARMADILLO"] if k in os.environ]
    gap_over_diagonal = float(options.get("gap", .02))
    scans = options.get("scans", "1,3,10,30,fall").split(",")
    print(f"{'body':10} {'scan':>5} {'points':>7} exit genus  min Q  {'rms':>8} {'99 %':>8} angle {'h':>8} {'lattice':>8} "
          f"{'gap':>8} {'tets':>8} {'CPU s':>6}   (rms, 99 % in gaps; angle in degrees)")
    with tempfile.TemporaryDirectory() as temporary:
        folder = options.get("keep", temporary)
        os.makedirs(folder, exist_ok=True)
        for name in names:
            body = known[name]() if name in known else Mesh(name)
            bounds = np.array(body.triangles().GetBounds()).reshape(3, 2)
            gap = gap_over_diagonal * np.linalg.norm(bounds[:, 1] - bounds[:, 0])
            for scan in scans:
                points, normals = falling(body, gap) if scan == "fall" else scan_lines(body, gap, float(scan))
                noise = float(options.get("noise", 0)) * gap * np.random.default_rng(7).standard_normal((len(points), 1))
                points = points + noise * normals
                case = os.path.join(folder, f"{body.name}_{scan}")
                write_ply(case + ".ply", points, None if options.get("normals") == "estimate" else normals)
                code, cpu, message = run(umtet, case + ".ply", case, ["--h", options["h"]] if "h" in options else [])
                row = f"{body.name:10} {scan:>5} {len(points):7} {code:4} "
                h = numbers(case, "certificate.json", "h")
                if h is None:
                    print(row + f"{'':66}{cpu:6.1f}  {message.splitlines()[0][:150] if message else ''}", flush=True)
                    continue
                rms, most, angle = measure(umtet, body, case)
                print(row + f"{numbers(case, 'certificate.json', 'boundary', 'genus')!s:>5} "
                      f"{numbers(case, 'certificate.json', 'quality', 'min'):6.3f} {rms / gap:9.4f} {most / gap:8.4f} {angle:5.2f} "
                      f"{h:8.4f} {numbers(case, '2-level-set/record.json', 'numbers', 'spacing'):8.4f} {gap:8.4f} "
                      f"{numbers(case, 'certificate.json', 'n_tets'):8} {cpu:6.1f}", flush=True)


if __name__ == "__main__":
    main()
