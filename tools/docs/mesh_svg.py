"""Tet meshes as vector drawings: the faces that are seen, shaded, as a few hundred bytes of SVG for a hundred of them.

Needs Debian's python3-vtk9, which reads the files.
"""
import numpy as np
from vtkmodules.util.numpy_support import vtk_to_numpy
from vtkmodules.vtkIOXML import vtkXMLUnstructuredGridReader

PIXELS = 800  # along a panel, of the raster that says what is seen
SHADES = 10
UNIT = 10  # of the drawing, per point: coordinates are whole numbers
LIGHT = np.array([.35, .55, 1.]) / np.linalg.norm([.35, .55, 1.])  # right, up, towards the eye
FACES = np.array([[1, 2, 3], [0, 3, 2], [0, 1, 3], [0, 2, 1]])  # outward, of a tet of positive volume


class Mesh:
    """points (n, 3), tets (m, 4), point_data: name -> array."""

    def __init__(self, path):
        reader = vtkXMLUnstructuredGridReader()
        reader.SetFileName(str(path))
        reader.Update()
        self.grid = reader.GetOutput()
        self.points = vtk_to_numpy(self.grid.GetPoints().GetData()).astype(float)
        self.tets = vtk_to_numpy(self.grid.GetCells().GetConnectivityArray()).reshape(-1, 4)
        data = self.grid.GetPointData()
        self.point_data = {data.GetArrayName(i): vtk_to_numpy(data.GetArray(i)) for i in range(data.GetNumberOfArrays())}

    def boundary(self, tets=None):
        """Faces of one tet of these, outward."""
        tets = self.tets if tets is None else tets
        faces = tets[:, FACES].reshape(-1, 3)
        _, first, count = np.unique(np.sort(faces, 1), axis=0, return_index=True, return_counts=True)
        return faces[np.sort(first[count == 1])]

    def cut(self, normal, offset=0):
        """The boundary of the tets behind a plane, and which of its faces the cut has laid open."""
        behind = self.tets[self.points[self.tets].mean(1) @ np.asarray(normal, float) < offset]
        faces, outer = self.boundary(behind), {tuple(f) for f in np.sort(self.boundary(), 1).tolist()}
        return faces, np.array([tuple(f) not in outer for f in np.sort(faces, 1).tolist()])


def axes_of_view(azimuth, elevation):
    """Rows right, up and towards the eye; degrees, azimuth from x to y of where the eye is."""
    a, e = np.radians([azimuth, elevation])
    towards = np.array([np.cos(e) * np.cos(a), np.cos(e) * np.sin(a), np.sin(e)])
    right = np.array([-np.sin(a), np.cos(a), 0])
    return np.array([right, np.cross(towards, right), towards])


def raster(x, depth):
    """For triangles x (n, 3, 2) in pixels: how many pixels each covers, and on how many it is nearest."""
    nearest = np.full((PIXELS + 2, PIXELS + 2), np.inf)
    owner = np.full(nearest.shape, -1)
    covered = np.zeros(len(x), int)
    for k, (a, b, c) in enumerate(x):
        low, high = np.floor(np.minimum(np.minimum(a, b), c)).astype(int), np.ceil(np.maximum(np.maximum(a, b), c)).astype(int)
        i, j = np.meshgrid(np.arange(low[0], high[0] + 1), np.arange(low[1], high[1] + 1), indexing="ij")
        u, v, d = b - a, c - a, np.stack([i - a[0], j - a[1]])
        det = u[0] * v[1] - u[1] * v[0]
        s, t = (d[0] * v[1] - d[1] * v[0]) / det, (u[0] * d[1] - u[1] * d[0]) / det
        z = depth[k, 0] + s * (depth[k, 1] - depth[k, 0]) + t * (depth[k, 2] - depth[k, 0])
        here = (s >= 0) & (t >= 0) & (s + t <= 1)
        covered[k] = here.sum()
        part = slice(low[0], high[0] + 1), slice(low[1], high[1] + 1)
        here &= z < nearest[part]
        nearest[part][here] = z[here]
        owner[part][here] = k
    return covered, np.bincount(owner[owner >= 0], minlength=len(x))


def drawing(points, faces, paint, view, centre, scale, at):
    """SVG of the faces that are seen.

    points (n, 3), faces (m, 3) outward; paint: a colour (r, g, b) of 0 to 255, or one a face; scale: points of the page a
    model unit; at: where `centre` goes, in points of the page.
    """
    paint = np.broadcast_to(np.asarray(paint, float), (len(faces), 3))
    p = (points - centre) @ view.T
    corners = p[faces]
    normal = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    front = normal[:, 2] > 1e-9 * np.linalg.norm(normal, axis=1).max()
    corners, normal, paint = corners[front], normal[front], paint[front]
    low, high = corners[..., :2].reshape(-1, 2).min(0), corners[..., :2].reshape(-1, 2).max(0)
    covered, seen = raster((corners[..., :2] - low) * (PIXELS / (high - low).max()), -corners[..., 2])
    whole = (seen == covered) & (covered > 0)
    shade = np.clip(normal @ LIGHT / np.linalg.norm(normal, axis=1), 0, 1)
    shade = np.round(shade * (SHADES - 1)) / (SHADES - 1)
    colours = [f"#{r:02x}{g:02x}{b:02x}" for r, g, b in np.round(paint * (.45 + .55 * shade)[:, None]).astype(int)]
    flat = np.round(UNIT * (np.asarray(at) + scale * corners[..., :2] * [1, -1])).astype(int)

    def path(k):
        (x, y), (u, v), (s, t) = flat[k].tolist()
        return f"M{x} {y}l{u - x} {v - y} {s - u} {t - v}z".replace(" -", "-")

    out = []
    # What is seen in part is drawn from behind; what is seen as a whole hides it, and is hidden by nothing.
    for k in np.argsort(corners[:, :, 2].mean(1), kind="stable"):
        if seen[k] > 0 and not whole[k]:
            out.append(f'<path fill="{colours[k]}" d="{path(k)}"/>')
    by_colour = {}
    for k in np.flatnonzero(whole):
        by_colour.setdefault(colours[k], []).append(path(k))
    out += [f'<path fill="{c}" d="{"".join(paths)}"/>' for c, paths in by_colour.items()]
    return out


class Page:
    """An SVG file of drawings and words; lengths in points."""

    def __init__(self, width, height):
        self.size, self.parts = (width, height), []

    def mesh(self, *arguments, line=.2):
        self.parts += [f'<g stroke="#1d2b3a" stroke-width="{UNIT * line:g}" stroke-linejoin="round">',
                       *drawing(*arguments), "</g>"]

    def text(self, x, y, words, anchor="middle", size=9):
        self.parts.append(f'<text x="{UNIT * x:g}" y="{UNIT * y:g}" text-anchor="{anchor}" font-size="{UNIT * size:g}">{words}</text>')

    def save(self, path):
        w, h = self.size
        head = (f'<svg xmlns="http://www.w3.org/2000/svg" width="{w}pt" height="{h}pt" viewBox="0 0 {UNIT * w} {UNIT * h}" '
                'font-family="DejaVu Sans, sans-serif">')
        path.write_text("\n".join([head, f'<rect width="{UNIT * w}" height="{UNIT * h}" fill="#fff"/>', *self.parts, "</svg>", ""]))
