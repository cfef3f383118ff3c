"""Triangle meshes as vtkPolyData: corners, random points, distances, genus."""
import pathlib

import numpy as np
import vtk
from vtk.util.numpy_support import numpy_to_vtk, vtk_to_numpy


READERS = {".ply": vtk.vtkPLYReader, ".stl": vtk.vtkSTLReader, ".obj": vtk.vtkOBJReader}


def read(file):
    """A PLY, STL or OBJ; corners of an STL at the same place are one."""
    reader = READERS[pathlib.Path(file).suffix.lower()]()
    reader.SetFileName(str(file))
    reader.Update()
    return reader.GetOutput()


def joined(mesh):
    """Triangles only, and corners at the same place are one."""
    triangles = vtk.vtkTriangleFilter()
    triangles.PassLinesOff()
    triangles.PassVertsOff()
    triangles.SetInputData(mesh)
    clean = vtk.vtkCleanPolyData()
    clean.PointMergingOn()
    clean.SetTolerance(0)
    clean.SetInputConnection(triangles.GetOutputPort())
    clean.Update()
    return clean.GetOutput()


def corners(mesh):
    """Vertices, and three numbers of vertices a triangle."""
    points = vtk_to_numpy(mesh.GetPoints().GetData()).astype(float)
    faces = vtk_to_numpy(mesh.GetPolys().GetConnectivityArray()).reshape(-1, 3)
    return points, faces


def middles_and_crosses(mesh):
    """Of the triangles: middles, and normals of twice their area."""
    x, faces = corners(mesh)
    a, b, c = (x[faces[:, k]] for k in range(3))
    return (a + b + c) / 3, np.cross(b - a, c - a)


def area(mesh):
    return np.linalg.norm(middles_and_crosses(mesh)[1], axis=1).sum() / 2


def diagonal(mesh):
    bounds = np.array(mesh.GetBounds()).reshape(3, 2)
    return np.linalg.norm(bounds[:, 1] - bounds[:, 0])


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


def distances(points, mesh):
    """From points to the nearest point of the triangles."""
    distance = vtk.vtkImplicitPolyDataDistance()
    distance.SetInput(mesh)
    given, found = numpy_to_vtk(np.ascontiguousarray(points, float), deep=True), vtk.vtkDoubleArray()
    distance.FunctionValue(given, found)
    return np.abs(vtk_to_numpy(found))


def pieces_and_genus(mesh):
    """Pieces, and the sum of their genera; None for the genus of a mesh that is not closed."""
    faces = corners(mesh)[1]
    parts = vtk.vtkPolyDataConnectivityFilter()
    parts.SetInputData(mesh)
    parts.SetExtractionModeToAllRegions()
    parts.Update()
    pieces = parts.GetNumberOfExtractedRegions()
    edges = np.sort(np.concatenate([faces[:, [0, 1]], faces[:, [1, 2]], faces[:, [2, 0]]]), 1)
    n_edges, of_faces = np.unique(edges, axis=0, return_counts=True)
    if (of_faces != 2).any():
        return pieces, None
    euler = len(np.unique(faces)) - len(n_edges) + len(faces)
    return pieces, (2 * pieces - euler) // 2
