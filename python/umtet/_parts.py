"""A mesh of several processes, of which each has a local mesh."""
import pickle
from typing import TYPE_CHECKING, Any, Optional, Protocol

import numpy as np
import numpy.typing as npt

from ._settings import Settings

if TYPE_CHECKING:
    from . import _distributed


class Communicator(Protocol):
    """The part of mpi4py.MPI.Comm that is used."""
    @property
    def rank(self) -> int:
        ...

    def py2f(self) -> int:
        ...

    def bcast(self, obj: Any, root: int = 0) -> Any:
        ...


class MeshPart:
    """The local mesh of one process: its tets, with all their vertices. Each tet is in one local mesh; a vertex is in all
    local meshes that contain a tet with it. A local mesh may be empty.

    points: (n, 3). tets: (m, 4) indices into points, with positive orientation.
    boundary: (k, 3) faces of these tets on the boundary of the whole mesh, counter-clockwise from outside.
    patches: these faces by name: boundary, or boundary_1, boundary_2 ... if there are several pieces. The names are the
    same in all processes.
    boundary_vertices: the points on the boundary of the whole mesh, also those without a local boundary face.

    global_vertex (n,), global_tet (m,), global_face (k,): indices into points, tets and boundary of the mesh that
    umtet.mesh() makes in one process.
    owner (n,): the owner of each vertex, which is the first process with this vertex.
    solver_vertex (n,): a number of each vertex. Each process numbers the vertices that it owns in the order of points,
    following the numbers of the processes before it.
    shared: for each other process, the vertices that it also has, in the same order in both processes.
    background_vertex, background_tet: ids in the background mesh.

    With mesh(order=2), tets is (m, 10) and boundary and patches are (k, 6), with the node order of Mesh. points contains
    corners, then mid-sides, and global_vertex, owner, solver_vertex, shared, boundary_vertices and n_vertices refer to
    these nodes. In the whole mesh mid-sides also follow all corners; their background_vertex is -1.

    n_vertices, n_tets: numbers in the whole mesh. h, certificate: as in umtet.Mesh, for the whole mesh, in all processes.
    comm: the communicator.
    """
    points: npt.NDArray[np.float64]
    tets: npt.NDArray[np.int32]
    boundary: npt.NDArray[np.int32]
    boundary_vertices: npt.NDArray[np.int32]
    patches: dict[str, npt.NDArray[np.int32]]
    global_vertex: npt.NDArray[np.int64]
    global_tet: npt.NDArray[np.int64]
    global_face: npt.NDArray[np.int64]
    owner: npt.NDArray[np.int32]
    solver_vertex: npt.NDArray[np.int64]
    shared: dict[int, npt.NDArray[np.int32]]
    background_vertex: npt.NDArray[np.int64]
    background_tet: npt.NDArray[np.int64]
    n_vertices: int
    n_tets: int
    h: float
    certificate: dict[str, Any]

    def __init__(self, core: "_distributed.MeshPart", comm: Communicator):
        self.comm = comm
        for name in MeshPart.__annotations__:
            setattr(self, name, getattr(core, name))

    @property
    def certified(self) -> bool:
        """True if the certificate of the whole mesh passes; otherwise certificate["reasons"] lists the reasons."""
        return bool(self.certificate["verdict"].startswith("pass"))

    def __repr__(self) -> str:
        return (f"<umtet.MeshPart: {len(self.tets)} of {self.n_tets} tets, {len(self.points)} of {self.n_vertices} "
                f"vertices, h = {self.h:.4g}>")


def _as_sent(error: BaseException) -> BaseException:
    try:
        pickle.loads(pickle.dumps(error))
        return error
    except Exception:  # an exception of the user may contain any object
        return RuntimeError(f"{type(error).__name__}: {error}")


def mesh_of_all(comm: Communicator, psi: Any, settings: Settings, t: Optional[float], progress: Any, threads: int) -> MeshPart:
    """Implements umtet.mesh(comm=comm). An exception of the first process is raised in all processes."""
    try:
        from . import _distributed
    except ImportError as error:
        raise ImportError("comm: this umtet is built without MPI (umtet._distributed is missing): cmake --preset mpi "
                          "builds it") from error
    if not hasattr(comm, "py2f"):
        raise TypeError("comm must be a communicator of mpi4py, such as MPI.COMM_WORLD")
    part: Optional["_distributed.MeshPart"] = None
    failure: Optional[BaseException] = None
    try:
        part = _distributed.mesh(comm.py2f(), psi, settings, t, progress if comm.rank == 0 else None, threads)
    except BaseException as error:  # also Ctrl-C, because the other processes wait
        failure = error
    told = comm.bcast(_as_sent(failure) if failure else None, root=0)
    if failure or told:
        raise failure or told
    assert part is not None
    return MeshPart(part, comm)
