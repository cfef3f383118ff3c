"""A mesh of several processes, as each of them holds it."""
import pickle
from typing import TYPE_CHECKING, Any, Optional, Protocol

import numpy as np
import numpy.typing as npt

from ._settings import Settings

if TYPE_CHECKING:
    from . import _distributed


class Communicator(Protocol):
    """What is used of mpi4py.MPI.Comm."""
    @property
    def rank(self) -> int:
        ...

    def py2f(self) -> int:
        ...

    def bcast(self, obj: Any, root: int = 0) -> Any:
        ...


class MeshPart:
    """What one process has of a mesh: its tets, with all their vertices. Each tet is in one part; vertices between parts
    are in all that have tets with them. A process may have none.

    points (n, 3); tets (m, 4), indices into points, positive; boundary (k, 3), faces of these tets on the boundary of the
    whole mesh, counter-clockwise from outside; patches, the same by name: boundary, or boundary_1, boundary_2 ... where it
    is several pieces, the same names in all processes. boundary_vertices: points on it, also those whose faces are others'.

    global_vertex (n,), global_tet (m,), global_face (k,): numbers in the whole mesh: places in points, tets and
    boundary of what umtet.mesh() makes in one process. owner (n,): the process that owns a vertex, the first that has
    it. solver_vertex (n,): its number where each process counts those that it owns, one process after the other, in the
    order of points. shared: of each other process the vertices that it has, too, in one order on both sides.
    background_vertex, background_tet: ids in the background.

    Of mesh(order=2): tets (m, 10) and boundary (k, 6), patches among them, have the nodes in the order that Mesh has them.
    points are these nodes, corners before mid-sides, and what is said of vertices is said of nodes: global_vertex, owner,
    solver_vertex, shared, boundary_vertices, n_vertices. In the whole mesh, too, mid-sides come behind all corners; their
    background_vertex is -1.

    n_vertices, n_tets: of all. h, certificate: as of umtet.Mesh, of the whole mesh, in all processes. comm: what was given.
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
        """True if nothing is wrong with the whole mesh; certificate["reasons"] lists what is."""
        return bool(self.certificate["verdict"].startswith("pass"))

    def __repr__(self) -> str:
        return (f"<umtet.MeshPart: {len(self.tets)} of {self.n_tets} tets, {len(self.points)} of {self.n_vertices} "
                f"vertices, h = {self.h:.4g}>")


def _as_sent(error: BaseException) -> BaseException:
    try:
        pickle.loads(pickle.dumps(error))
        return error
    except Exception:  # what an exception of others holds may be anything
        return RuntimeError(f"{type(error).__name__}: {error}")


def mesh_of_all(comm: Communicator, psi: Any, settings: Settings, t: Optional[float], progress: Any, threads: int) -> MeshPart:
    """umtet.mesh(comm=comm). What the first process raises all raise."""
    try:
        from . import _distributed
    except ImportError as error:
        raise ImportError("comm: this umtet is built without MPI (umtet._distributed is missing): cmake --preset mpi "
                          "builds it") from error
    if not hasattr(comm, "py2f"):
        raise TypeError("comm: a communicator of mpi4py is wanted, such as MPI.COMM_WORLD")
    part: Optional["_distributed.MeshPart"] = None
    failure: Optional[BaseException] = None
    try:
        part = _distributed.mesh(comm.py2f(), psi, settings, t, progress if comm.rank == 0 else None, threads)
    except BaseException as error:  # Ctrl-C, too: the others wait
        failure = error
    told = comm.bcast(_as_sent(failure) if failure else None, root=0)
    if failure or told:
        raise failure or told
    assert part is not None
    return MeshPart(part, comm)
