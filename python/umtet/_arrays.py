"""Reads the arrays of clouds and meshes of other packages, without importing these packages.

It accepts objects with the attributes of Open3D (points, normals; vertices, triangles, vertex_normals), pyvista (points,
point_data, faces, cells_dict), meshio (points, point_data, cells_dict) and trimesh (vertices, faces).
"""
from typing import Any, Optional

import numpy as np
import numpy.typing as npt

_VTK_TETRA, _VTK_TRIANGLE = 10, 5


def _attribute(thing: Any, *names: str) -> Any:
    """Returns the first of these attributes that exists and is not empty."""
    for name in names:
        value = getattr(thing, name, None)
        if value is not None and not callable(value) and len(value) > 0:
            return value
    return None


def _cells(thing: Any, *names: Any) -> Optional[npt.NDArray[np.int64]]:
    cells = getattr(thing, "cells_dict", None) or {}
    return next((np.asarray(cells[name], np.int64) for name in names if name in cells), None)


def _triangles(thing: Any) -> Optional[npt.NDArray[np.int64]]:
    found = _cells(thing, "triangle", _VTK_TRIANGLE)
    if found is not None:
        return found
    faces = _attribute(thing, "triangles", "faces")
    if faces is None:
        return None
    array = np.asarray(faces, np.int64)
    if array.ndim == 1:  # pyvista: the number of corners before each face
        if len(array) % 4 or (array[::4] != 3).any():
            raise ValueError("points: a mesh must consist of triangles; its triangulate() makes them")
        array = array.reshape(-1, 4)[:, 1:]
    if array.ndim != 2 or array.shape[1] != 3:
        raise ValueError(f"points: its faces are an array {array.shape}, not triangles (m, 3)")
    return array


def _vertex_normals(points: npt.NDArray[np.float64], triangles: npt.NDArray[np.int64]) -> npt.NDArray[np.float64]:
    """Returns vertex normals: sums of the normals of the adjacent triangles, weighted by area."""
    a, b, c = (points[triangles[:, k]] for k in range(3))
    twice_area = np.cross(b - a, c - a)
    normals = np.zeros_like(points)
    for k in range(3):
        np.add.at(normals, triangles[:, k], twice_area)
    return normals


def cloud_of(points: Any, normals: Any) -> tuple[npt.NDArray[np.float64], Optional[npt.NDArray[np.float64]]]:
    """Returns points and normals: the arguments if they are arrays, otherwise the arrays of an object. The points of a
    surface mesh are its vertices."""
    found = None if isinstance(points, (np.ndarray, list, tuple)) else _attribute(points, "points", "vertices")
    if found is None:
        return points, normals
    x = np.asarray(found, float)
    if normals is None:
        data = getattr(points, "point_data", None) or {}
        names = [name for name in ("Normals", "normals") if name in data]
        normals = data[names[0]] if names else _attribute(points, "normals", "vertex_normals")
    if normals is None:
        triangles = _triangles(points)
        normals = None if triangles is None else _vertex_normals(x, triangles)
    return x, None if normals is None else np.asarray(normals, float)


def tets_of(mesh: Any) -> tuple[npt.NDArray[np.float64], npt.NDArray[np.int64]]:
    """Returns the points and tets of a mesh; for tets with 10 nodes only the corners."""
    points = _attribute(mesh, "points")
    tets = _attribute(mesh, "tets")
    if tets is None:
        tets = _cells(mesh, "tetra", _VTK_TETRA)
    if points is None or tets is None:
        raise TypeError("tets must be an array (m, 4), or points must be a mesh that contains points and tets")
    return np.asarray(points, float), np.asarray(tets)[:, :4]
