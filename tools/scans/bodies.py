"""Bodies whose surface is known: ball, torus and eq. (9) by formulas, a bracket of tubes, closed triangle meshes; and
the clouds of data/clouds. Random samples of them, and the distances of points to them."""
import functools
import os
import pathlib

import numpy as np
import vtk
from scipy.spatial import cKDTree
from vtk.util.numpy_support import numpy_to_vtk

import triangle_mesh
from cloud_files import read_ply

REPOSITORY = pathlib.Path(__file__).resolve().parents[2]
SHARED = pathlib.Path(os.environ.get("UMTET_SHARED", REPOSITORY.parent / "shared"))  # scans that are not stored here
GRID = 160  # of the triangles that implicit bodies are sampled from


class Body:
    """What both kinds have: name, genus, mesh (its triangles), foot, on_surface, distance."""

    def sample(self, n, seed):
        """n random points, as many per area everywhere, and unit normals."""
        return self.on_surface(*triangle_mesh.random_points(self.mesh, n, lambda x: np.ones(len(x)), seed))

    def diagonal(self):
        return triangle_mesh.diagonal(self.mesh)


class Implicit(Body):
    def __init__(self, name, half_box, f, gradient, genus):
        self.name, self.half_box, self.f, self.gradient, self.genus = name, np.array(half_box), f, gradient, genus

    @functools.cached_property
    def mesh(self):
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

    def distance(self, x):
        """Of points near the surface, by the foot; of others to the triangles."""
        with np.errstate(all="ignore"):
            to_foot = np.linalg.norm(x - self.foot(x)[0], axis=1)
        to_triangles = triangle_mesh.distances(x, self.mesh)
        return np.where((to_triangles < .01 * self.diagonal()) & np.isfinite(to_foot), to_foot, to_triangles)


class Mesh(Body):
    """Closed triangles of a file; their normals are those of the vertices, between."""

    def __init__(self, path):
        self.name = pathlib.Path(path).stem
        normals = vtk.vtkPolyDataNormals()
        normals.SetInputData(triangle_mesh.read(path))
        normals.SplittingOff()
        normals.ConsistencyOn()
        normals.AutoOrientNormalsOn()
        normals.Update()
        self.mesh = normals.GetOutput()
        self.genus = triangle_mesh.pieces_and_genus(self.mesh)[1]

    @functools.cached_property
    def dense(self):
        points, normals = triangle_mesh.random_points(self.mesh, 1_000_000, lambda x: np.ones(len(x)), 5)
        return points, normals, cKDTree(points)

    def foot(self, x):
        """Points and normals in the tangent planes of the nearest of a million points."""
        points, normals, tree = self.dense
        nearest = tree.query(x)[1]
        p, n = points[nearest], normals[nearest]
        return x - np.sum((x - p) * n, 1, keepdims=True) * n, n

    def on_surface(self, x, normals):
        return x, normals / np.linalg.norm(normals, axis=1, keepdims=True)

    def distance(self, x):
        return triangle_mesh.distances(x, self.mesh)


def ball():
    return Implicit("ball", [1.1] * 3, lambda p: np.sum(p * p, -1) - 1, lambda p: 2 * p, 0)


def torus(R=1, r=.4):
    def gradient(p):
        s = 1 - R / np.hypot(p[:, 0], p[:, 1])
        return 2 * np.stack([p[:, 0] * s, p[:, 1] * s, p[:, 2]], 1)

    return Implicit("torus", [R + r + .1, R + r + .1, r + .1],
                    lambda p: (np.hypot(p[..., 0], p[..., 1]) - R)**2 + p[..., 2]**2 - r * r, gradient, 1)


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


def body(name):
    """One of the three above, the duck, or a closed mesh in a file."""
    if name == "duck":
        return Mesh(SHARED / "data/reference/duck.ply")
    known = {f.__name__: f for f in (ball, torus, eq_9)}
    if name in known:
        return known[name]()
    if not os.path.isfile(name):
        raise FileNotFoundError(f"{name}: neither {', '.join(known)}, duck nor a file")
    return Mesh(name)


def cloud(name):
    """Points and normals of data/clouds."""
    return read_ply(REPOSITORY / "data/clouds" / (name + ".ply"))[:2]


def random_ball(random, n):
    x = random.normal(size=(n, 3))
    x /= np.linalg.norm(x, axis=1)[:, None]
    return x, x.copy()


def random_torus(random, n, major=1.0, minor=0.4):
    v = random.uniform(0, 2 * np.pi, 4 * n)
    v = v[random.uniform(0, 1, 4 * n) < (major + minor * np.cos(v)) / (major + minor)][:n]
    u = random.uniform(0, 2 * np.pi, len(v))
    normal = np.stack([np.cos(v) * np.cos(u), np.cos(v) * np.sin(u), np.sin(v)], 1)
    return major * np.stack([np.cos(u), np.sin(u), 0 * u], 1) + minor * normal, normal


def random_bracket(random, n):
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


def random_trefoil(random, n, tube=0.35):
    """A tube of this radius around the trefoil (sin t + 2 sin 2t, cos t - 2 cos 2t, -sin 3t): a knot of genus 1."""
    t, v = random.uniform(0, 2 * np.pi, (2, 20 * n))
    place = np.stack([np.sin(t) + 2 * np.sin(2 * t), np.cos(t) - 2 * np.cos(2 * t), -np.sin(3 * t)], 1)
    first = np.stack([np.cos(t) + 4 * np.cos(2 * t), -np.sin(t) + 4 * np.sin(2 * t), -3 * np.cos(3 * t)], 1)
    second = np.stack([-np.sin(t) - 8 * np.sin(2 * t), -np.cos(t) + 8 * np.cos(2 * t), 9 * np.sin(3 * t)], 1)
    speed = np.linalg.norm(first, axis=1)
    along = first / speed[:, None]
    bend = second - np.sum(second * along, 1)[:, None] * along
    curvature = np.linalg.norm(bend, axis=1) / speed ** 2
    inward = bend / np.linalg.norm(bend, axis=1)[:, None]
    normal = np.cos(v)[:, None] * inward + np.sin(v)[:, None] * np.cross(along, inward)
    area = speed * (1 - curvature * tube * np.cos(v))  # over that of the parameters
    keep = (random.uniform(0, area.max(), len(t)) < area).nonzero()[0][:n]
    return (place + tube * normal)[keep], normal[keep]


def trefoil_volume(tube=0.35, n=100_000):
    """pi r^2 times the length of the curve (Pappus)."""
    t = np.arange(n) * 2 * np.pi / n
    first = np.stack([np.cos(t) + 4 * np.cos(2 * t), -np.sin(t) + 4 * np.sin(2 * t), -3 * np.cos(3 * t)], 1)
    return np.pi * tube ** 2 * np.linalg.norm(first, axis=1).mean() * 2 * np.pi
