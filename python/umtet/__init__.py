"""Certified tetrahedral meshes of oriented points, or of a level set psi that is negative inside the body.

    reconstruct(points, normals)  -> LevelSet     a C2 level set psi of a point cloud
    mesh(psi, ...)                -> Mesh         a boundary-fitting mesh of {psi < 0}, with its certificate
    mesh(psi, ..., comm=comm)     -> MeshPart     the local mesh of this process, made by all processes of comm (mpi4py)
    mesh_regions({"name": psi}, ...) -> RegionsMesh   one mesh of several bodies that share their interfaces
    UniversalMesh(box, h).update(psi) -> Update   meshes of a moving domain, in one background mesh
    certificate(points, tets)     -> dict         measurements of any tet mesh

psi is a LevelSet, a formula such as "x^2+y^2+z^2-1", or a callable. A callable f(points) receives an array (n, 3) and
returns values (n,), or (values, gradients (n, 3)), or (values, gradients, hessians (n, 3, 3)). Missing derivatives are
computed by central differences. The mesher calls it with blocks of hundreds to thousands of points, in the thread of the
caller. A callable of one point, f((x, y, z)), is also possible, but some hundred times slower. Level sets and formulas
are evaluated in C++, by all threads, without the GIL.

Further keyword arguments are the parameters of `umtet run --help` and case.toml, for example mesh(psi, mode="paper").
A progress callback is called as progress(step, fraction), mostly from another thread. If it returns False, the work ends
with the exception Cancelled. Ctrl-C ends the work with KeyboardInterrupt.

A broken contract, such as a parameter out of range, raises ValueError. A request that is impossible raises MeshingError
or ReconstructionError; its `evidence` is a dict with status, positions and lengths. A mesh whose certificate fails is
also returned: check `mesh.certified`.
"""
import os
from typing import Any, Callable, Mapping, Optional, Union, overload

import numpy as np
import numpy.typing as npt

from . import _core
from ._arrays import cloud_of, tets_of
from ._core import Cancelled, LevelSet, MeshingError, ReconstructionError
from ._mesh import Mesh, Update
from ._parts import Communicator, MeshPart, mesh_of_all
from ._regions import RegionsMesh
from ._settings import box_of, settings

__version__ = _core.__version__
__all__ = [
    "Cancelled", "LevelSet", "Mesh", "MeshPart", "MeshingError", "ReconstructionError", "RegionsMesh", "UniversalMesh", "Update",
    "certificate", "mesh", "mesh_regions", "reconstruct"
]

Psi = Union[LevelSet, str, "os.PathLike[str]", Callable[[npt.NDArray[np.float64]], Any]]
Progress = Callable[[str, float], Any]

for _public in (Cancelled, MeshingError, ReconstructionError, Mesh, MeshPart, RegionsMesh, Update):
    _public.__module__ = "umtet"  # the name that is printed

_NOT_OF_A_MOVING_MESH = ("tets", "max_tets", "max_deviation", "effort", "order")


def reconstruct(points: Any, normals: Optional[npt.ArrayLike] = None, *, normal_source: Optional[str] = None,
                progress: Optional[Progress] = None, threads: int = 0, **parameters: Any) -> LevelSet:
    """Fits a C2 level set to a point cloud, as `umtet reconstruct` does.

    points: an array (n, 3) of at least 30 points; or a cloud or surface mesh of Open3D, pyvista, meshio or trimesh; or
    the pathlib.Path of a file that `umtet run` reads. A surface mesh is used as the cloud of its vertices and their
    normals, so sample a mesh of few large faces first (Open3D: sample_points_uniformly).
    normals: an array (n, 3) of outward normals of any length; None: normals are estimated and oriented.
    columns: the columns of a text file, such as columns="x,y,z,nx,ny,nz".
    Other parameters: spacing, detail, smooth, noise, flip, ...
    Outliers and duplicates are dropped; keep_all=True keeps outliers. A reversed minority of the normals is turned over,
    except with normal_source="given". `report["notices"]` lists these changes.

    Returns a LevelSet with value(points), gradient(points), hessian(points), box (2, 3), the points and normals that were
    used, report, and save("level_set.vti"). Raises ReconstructionError if the samples do not bound a body, or if the fit
    needs more memory than is allowed.
    """
    if isinstance(points, (str, bytes)):
        raise TypeError("points must be an array (n, 3) or the pathlib.Path of a file")
    parameters["normals"] = normal_source
    if isinstance(points, os.PathLike):
        if normals is not None:
            raise TypeError("normals: the file contains the normals; omit this argument")
        return _core.reconstruct_file(points, settings(("cloud", "reconstruct"), parameters), progress, threads)
    if parameters.get("columns") is not None:
        raise TypeError("columns: only for the pathlib.Path of a file")
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

    psi: a LevelSet, a formula, a callable, or the pathlib.Path of a grid that `umtet mesh --level-set` reads (with the
    parameters level, part and part_smooth).
    box: a box around the domain, with a margin of two edges; a LevelSet contains its box.
    t: the value of t in a formula.
    h, tets, max_deviation: at most one of these. By default h follows from size and thickness.
    order=2: tets of 10 nodes with a curved boundary; the certificate proves that every Jacobian is positive.
    complement=True, with box_walls=True: meshes {psi > 0} up to the flat walls of the box, the fluid around the body.
    Other parameters: background="z", mode="paper", max_tets, min_quality, target_quality, seed, ...

    Returns a Mesh: the best of up to five if umtet chooses h. Mesh.certified tells whether it passes its certificate.
    Raises MeshingError if there is no mesh; its evidence contains the position, and an h that may suffice.

    comm: a communicator of mpi4py. All its processes make this call with the same arguments. Together they make the mesh
    that one process makes, and each gets a MeshPart. psi is a formula, a callable, a grid, or the LevelSet of the first
    process; the mesh is in fast mode, with one h and without walls, of order 1 or 2. threads is the number of threads
    per process (0: an equal share of the processors of its machine). progress is called in the first process. An
    exception of psi ends all processes (MPI_Abort).
    """
    parameters["box"] = box_of(box)
    given: Any = psi
    if isinstance(psi, os.PathLike):
        given, parameters["level_set"] = None, psi
    made = settings(("mesh",), parameters)
    if comm is not None:
        return mesh_of_all(comm, given, made, t, progress, threads)
    return Mesh(_core.mesh(given, made, t, progress, threads))


def mesh_regions(bodies: Mapping[str, Psi], *, box: Optional[npt.ArrayLike] = None, h: Optional[float] = None,
                 tets: Optional[int] = None, outside: bool = True, progress: Optional[Progress] = None,
                 threads: int = 0) -> RegionsMesh:
    """Makes one mesh of several bodies, as `umtet regions` does.

    bodies: for each name a LevelSet, a formula or a callable; later bodies cover earlier ones.
    box: what the mesh fills, with flat walls; required for formulas and callables. By default it leaves four edges around
    the LevelSets.
    h or tets: the edge length, or the number of tets (default 100000).
    outside=False leaves the rest of the box out.

    Returns a RegionsMesh, also if its certificate fails. Raises MeshingError if a body reaches the walls of the box, or if
    none is in it.
    """
    given = settings(("mesh",), {"box": box_of(box), "h": h, "tets": tets})
    return RegionsMesh(_core.mesh_regions(list(bodies.items()), given, outside, progress, threads))


class UniversalMesh:
    """Meshes of a domain that moves inside `box`, all in one background mesh of edge length h.

    It takes the parameters of mesh() in fast mode: background="z", target_quality, complement and box_walls, ...
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
        """Meshes {psi < 0}, starting from the former mesh.

        seeds: an array (k, 3) with a point near each new component. certify: also makes the certificate, which takes
        about as long as the mesh; otherwise it is None. After a MeshingError the next update starts from the last mesh.
        """
        return Update(*self._core.update(psi, t, seeds, certify, progress, threads))


def certificate(points: Any, tets: Optional[npt.ArrayLike] = None, psi: Optional[Psi] = None, *, h: float = 0,
                t: Optional[float] = None, **parameters: Any) -> dict[str, Any]:
    """Measures any tet mesh: exact signs of all volumes, boundary, quality; with psi also distances to psi = 0.

    points: an array (n, 3), and tets: an array (m, 4); or points is a mesh of meshio or pyvista that contains both.
    h: the edge length to which ratios refer (0: the mean edge length of the mesh). Parameters: min_quality.
    Returns a dict with keys of certificate.json: n_tets, volume, quality, boundary, gates, verdict, reasons.
    """
    if tets is None:
        points, tets = tets_of(points)
    tets = np.asarray(tets)
    if tets.dtype.kind not in "iu":
        raise TypeError(f"tets must be an array of integers, not of {tets.dtype}")
    return _core.certificate(points, tets, psi, settings((), parameters), t, h)
