"""From oriented points, or a level set psi < 0 inside, to certified tetrahedral meshes.

    reconstruct(points, normals)  -> LevelSet     a C2 level set psi of a point cloud
    mesh(psi, ...)                -> Mesh         a boundary-fitting mesh of {psi < 0}, with its certificate
    mesh(psi, ..., comm=comm)     -> MeshPart     what this process has of one mesh of all processes of comm (mpi4py)
    UniversalMesh(box, h).update(psi) -> Update   the same for a domain that moves, in one background mesh
    certificate(points, tets)     -> dict         what is true of any tet mesh

psi is a LevelSet, a formula such as "x^2+y^2+z^2-1", or a callable: f(points) is given an array (n, 3) and returns
values (n,), or (values, gradients (n, 3)), or (values, gradients, hessians (n, 3, 3)). What it does not return is made
of central differences. The mesher asks for blocks of hundreds to thousands of points, in your thread; a callable of one
point, f((x, y, z)), works too, some hundred times slower. Level sets and formulas are evaluated in C++, by all threads,
without the GIL.

Keyword arguments beyond those named are the parameters of `umtet run --help` and case.toml: mesh(psi, mode="paper").
A progress callback is called as progress(step, fraction), mostly from another thread; when it returns False the work is
stopped with Cancelled.
Ctrl-C stops it with KeyboardInterrupt.

ValueError: a broken contract, such as a parameter out of range. MeshingError and ReconstructionError: what was asked for
is not possible; their `evidence` is a dict with status, places and lengths. A mesh whose certificate fails is returned:
look at `mesh.certified`.
"""
import os
from typing import Any, Callable, Optional, Union, overload

import numpy as np
import numpy.typing as npt

from . import _core
from ._arrays import cloud_of, tets_of
from ._core import Cancelled, LevelSet, MeshingError, ReconstructionError
from ._mesh import Mesh, Update
from ._parts import Communicator, MeshPart, mesh_of_all
from ._settings import box_of, settings

__version__ = _core.__version__
__all__ = [
    "Cancelled", "LevelSet", "Mesh", "MeshPart", "MeshingError", "ReconstructionError", "UniversalMesh", "Update", "certificate",
    "mesh", "reconstruct"
]

Psi = Union[LevelSet, str, "os.PathLike[str]", Callable[[npt.NDArray[np.float64]], Any]]
Progress = Callable[[str, float], Any]

for _public in (Cancelled, MeshingError, ReconstructionError, Mesh, MeshPart, Update):
    _public.__module__ = "umtet"  # as they are printed

_NOT_OF_A_MOVING_MESH = ("tets", "max_tets", "max_deviation", "effort", "order")


def reconstruct(points: Any, normals: Optional[npt.ArrayLike] = None, *, normal_source: Optional[str] = None,
                progress: Optional[Progress] = None, threads: int = 0, **parameters: Any) -> LevelSet:
    """Fits a C2 level set to a point cloud, as `umtet reconstruct` does.

    points (n, 3), 30 at least; normals (n, 3) outward, of any length, or None: estimated and oriented. In place of points
    an object that has them: a cloud or a surface mesh of Open3D, pyvista, meshio or trimesh. Of a mesh the vertices
    count, with its normals; one of few large faces is sampled before (Open3D: sample_points_uniformly). Or the
    pathlib.Path of a file that `umtet run` reads; columns="x,y,z,nx,ny,nz" are those of a table in text. Outliers and
    duplicates are dropped (keep_all=True keeps outliers), a minority of turned normals is turned back (not with
    normal_source="given"); `report["notices"]` says what was done. Parameters: spacing, detail, smooth, noise, flip, ...

    Returns a LevelSet: value(points), gradient(points), hessian(points), box (2, 3), points and normals that were used,
    report, save("level_set.vti"). ReconstructionError: the samples do not bound a body, or it would not fit in memory.
    """
    if isinstance(points, (str, bytes)):
        raise TypeError("points: an array (n, 3) or the pathlib.Path of a file is wanted")
    parameters["normals"] = normal_source
    if isinstance(points, os.PathLike):
        if normals is not None:
            raise TypeError("normals: those of the file are taken")
        return _core.reconstruct_file(points, settings(("cloud", "reconstruct"), parameters), progress, threads)
    if parameters.get("columns") is not None:
        raise TypeError("columns: are those of a file")
    x, n = cloud_of(points, normals)
    return _core.reconstruct(x, n, settings(("cloud", "reconstruct"), parameters), progress, threads)


@overload
def mesh(psi: Psi, *, box: Optional[npt.ArrayLike] = None, t: Optional[float] = None, progress: Optional[Progress] = None,
         threads: int = 0, comm: None = None, **parameters: Any) -> Mesh:
    ...


@overload
def mesh(psi: Psi, *, box: Optional[npt.ArrayLike] = None, t: Optional[float] = None, progress: Optional[Progress] = None,
         threads: int = 0, comm: Communicator, **parameters: Any) -> MeshPart:
    ...


def mesh(psi: Psi, *, box: Optional[npt.ArrayLike] = None, t: Optional[float] = None, progress: Optional[Progress] = None,
         threads: int = 0, comm: Optional[Communicator] = None, **parameters: Any) -> Union[Mesh, MeshPart]:
    """Meshes {psi < 0}, as `umtet mesh` does.

    psi: a LevelSet, a formula, a callable, or the pathlib.Path of a grid as `umtet mesh --level-set` reads it (level, part,
    part_smooth).
    box: around the domain, with room of two edges; a LevelSet has its own. t: what t stands for in a formula. One of
    h, tets and max_deviation, or none (h from size and thickness). order=2: tets of 10 nodes with curved boundary, every
    Jacobian proved positive in the certificate. Other parameters: background="z", mode="paper",
    max_tets, min_quality, target_quality, seed, ...; complement=True with box_walls=True: {psi > 0} up to
    the flat walls of the box, the fluid around the body.

    Returns a Mesh, the best of up to five where the choice of h is left to umtet. MeshingError: there is none;
    evidence says where, and which h may do. Mesh.certified says whether what is there is right.

    comm: a communicator of mpi4py. All its processes call with the same arguments, make the mesh of one process together
    and get a MeshPart each; of a formula, a callable, a grid or the LevelSet of the first, in fast mode, one h, without
    walls, of either order. threads are those of each process (0: a share of its machine). progress is called in the
    first. What psi raises ends all (MPI_Abort).
    """
    parameters["box"] = box_of(box)
    given: Any = psi
    if isinstance(psi, os.PathLike):
        given, parameters["level_set"] = None, psi
    made = settings(("mesh",), parameters)
    if comm is not None:
        return mesh_of_all(comm, given, made, t, progress, threads)
    return Mesh(_core.mesh(given, made, t, progress, threads))


class UniversalMesh:
    """Meshes of a domain that moves inside `box`, all in one background mesh of edge length h.

    Parameters are those of mesh() in fast mode: background="z", target_quality, complement and box_walls, ...
    """

    def __init__(self, box: npt.ArrayLike, h: float, **parameters: Any):
        self._core = _core.Moving(settings(("mesh",), {**parameters, "box": box_of(box), "h": h}, _NOT_OF_A_MOVING_MESH))

    @property
    def h(self) -> float:
        return self._core.h

    @property
    def n_background_vertices(self) -> int:
        """Size of the range of background vertex ids."""
        return self._core.n_vertices

    def update(self, psi: Psi, *, t: Optional[float] = None, seeds: Optional[npt.ArrayLike] = None, certify: bool = False,
               progress: Optional[Progress] = None, threads: int = 0) -> Update:
        """The mesh of {psi < 0}, from the one before.

        seeds (k, 3): a point near each component that is new. certify: the mesh gets its certificate, for about the
        time of a mesh (else it is None). MeshingError leaves the last mesh as what the next update starts from.
        """
        return Update(*self._core.update(psi, t, seeds, certify, progress, threads))


def certificate(points: Any, tets: Optional[npt.ArrayLike] = None, psi: Optional[Psi] = None, *, h: float = 0,
                t: Optional[float] = None, **parameters: Any) -> dict[str, Any]:
    """What is true of any tet mesh: exact signs of all volumes, boundary, quality; with psi also distances to psi = 0.

    points (n, 3), tets (m, 4); or one mesh that has both, of meshio or pyvista, and psi by name. h is what ratios refer to
    (0: the mesh's own edge length). Parameters: min_quality.
    Returns a dict with keys of certificate.json: n_tets, volume, quality, boundary, gates, verdict, reasons.
    """
    if tets is None:
        points, tets = tets_of(points)
    tets = np.asarray(tets)
    if tets.dtype.kind not in "iu":
        raise TypeError(f"tets: an array of integers is wanted, not of {tets.dtype}")
    return _core.certificate(points, tets, psi, settings((), parameters), t, h)
