"""Tet meshes in files, measured by numpy alone: volume, pieces, genus, quality, boundary. No number of umtet is used."""
from typing import NamedTuple

import meshio
import numpy as np
from scipy.sparse import coo_matrix
from scipy.sparse.csgraph import connected_components

FACES = np.array([[1, 2, 3], [0, 3, 2], [0, 1, 3], [0, 2, 1]])  # of a tet of positive volume; they look outward


class TetMesh(NamedTuple):
    points: np.ndarray  # (n, 3)
    tets: np.ndarray  # (m, 4)
    data: dict  # of points, by name


def read(file):
    """A .vtu, .msh or .mesh. Of tets with ten nodes the corners are read."""
    mesh = meshio.read(file)
    tets = [block.data[:, :4] for block in mesh.cells if block.type in ("tetra", "tetra10")]
    if not tets:
        raise ValueError(f"{file}: there are no tets")
    return TetMesh(mesh.points.astype(float), np.concatenate(tets).astype(int), dict(mesh.point_data))


def signed_volumes(points, tets):
    a, b, c, d = (points[tets[:, k]] for k in range(4))
    return np.einsum("ij,ij->i", b - a, np.cross(c - a, d - a)) / 6


def volume(mesh):
    return np.abs(signed_volumes(mesh.points, mesh.tets)).sum()


def mean_ratios(mesh):
    """12 (9 V^2)^(1/3) / (sum of the squares of the six edges): 1 for a regular tet, 0 for a flat one."""
    x = mesh.points[mesh.tets]
    edges2 = sum(np.sum((x[:, i] - x[:, j])**2, 1) for i in range(4) for j in range(i))
    signed = signed_volumes(mesh.points, mesh.tets)
    return 12 * np.sign(signed) * np.cbrt(9 * signed**2) / edges2


def boundary(mesh):
    """Faces of one tet only, (n, 3), that look outward."""
    tets = mesh.tets.copy()
    inverted = signed_volumes(mesh.points, tets) < 0
    tets[inverted] = tets[inverted][:, [1, 0, 2, 3]]
    faces = tets[:, FACES].reshape(-1, 3)
    _, first, count = np.unique(np.sort(faces, 1), axis=0, return_index=True, return_counts=True)
    return faces[first[count == 1]]


def labels_of(n, pairs):
    """For each of n things the number of its connected component, (n,)."""
    graph = coo_matrix((np.ones(len(pairs)), (pairs[:, 0], pairs[:, 1])), shape=(n, n))
    return connected_components(graph, directed=False)[1]


def n_bodies(mesh):
    """Pieces of tets that share faces."""
    faces = np.sort(mesh.tets[:, FACES].reshape(-1, 3), 1)
    order = np.lexsort(faces.T)
    same = (faces[order[1:]] == faces[order[:-1]]).all(1)
    pairs = np.stack([order[:-1][same] // 4, order[1:][same] // 4], 1)
    return len(np.unique(labels_of(len(mesh.tets), pairs)))


def edges_of(faces):
    """Edges, (n, 2), and by how many faces each is used."""
    edges = np.sort(np.concatenate([faces[:, [0, 1]], faces[:, [1, 2]], faces[:, [2, 0]]]), 1)
    return np.unique(edges, axis=0, return_counts=True)


class Surface(NamedTuple):
    pieces: int
    genus: int  # sum over the pieces; None where the triangles bound nothing


def surface(faces):
    """Pieces and genus of triangles that share vertices."""
    used, faces = np.unique(faces, return_inverse=True)
    faces = faces.reshape(-1, 3)
    edges, of_faces = edges_of(faces)
    pieces = len(np.unique(labels_of(len(used), edges)))
    if (of_faces != 2).any():
        return Surface(pieces, None)
    euler = len(used) - len(edges) + len(faces)
    return Surface(pieces, (2 * pieces - euler) // 2)


def enclosed_volume(points, faces):
    """Of triangles that look outward; negative if they look inward."""
    origin = points.mean(0)  # far coordinates lose no digits
    a, b, c = (points[faces[:, k]] - origin for k in range(3))
    return np.einsum("ij,ij->i", a, np.cross(b, c)).sum() / 6


def rims(faces):
    """Closed loops of directed edges that one triangle has and no other has the other way round: what is open."""
    directed = np.concatenate([faces[:, [0, 1]], faces[:, [1, 2]], faces[:, [2, 0]]])
    there = set(map(tuple, directed))
    following = {a: b for a, b in there if (b, a) not in there}
    loops = []
    while following:
        start, at = following.popitem()
        loop = [start]
        while at != start and at in following:
            loop.append(at)
            at = following.pop(at)
        if at == start:
            loops.append(loop)
    return loops


def closed_flat(points, faces):
    """The same with a fan around the middle of every rim: exact where a rim is plane."""
    loops = rims(faces)
    middles = [points[loop].mean(0) for loop in loops]
    fans = [[loop[(k + 1) % len(loop)], loop[k], len(points) + m] for m, loop in enumerate(loops)
            for k in range(len(loop))]
    if not loops:
        return points, faces
    return np.vstack([points, middles]), np.vstack([faces, fans])
