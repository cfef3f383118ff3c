"""The results of umtet.mesh() and UniversalMesh.update()."""
import os
from typing import Any, Optional, Union

import numpy as np
import numpy.typing as npt

from . import _core
from ._settings import PATCHES, settings

_CELL_NAMES = {3: "triangle", 6: "triangle6", 4: "tetra", 10: "tetra10"}
_VTK_TETS = {4: 10, 10: 24}


class Mesh:
    """A tet mesh that fits {psi = 0}, with the ids of its background.

    points: (n, 3) float64.
    tets: (m, 4) indices into points, with positive orientation.
    boundary: (k, 3) faces on psi = 0, counter-clockwise from outside. walls: (w, 3) faces in the walls of the box
    (complement=True). boundary_vertices: the nodes on psi = 0.
    background_vertex, background_tet: (n,) and (m,) ids in the background mesh. h: its mean edge length.
    certificate: a dict with the keys of certificate.json, except `run` and the checksum.
    notices: texts about changes to a grid that was read.

    With mesh(order=2), tets is (m, 10): the corners, then the mid-sides of the edges 01 12 20 03 13 23, in the order of
    VTK. boundary is (k, 6): the corners, then the mid-sides of 01 12 20. In points, mid-sides follow the corners; their
    background_vertex is -1.
    """
    points: npt.NDArray[np.float64]
    tets: npt.NDArray[np.int32]
    boundary: npt.NDArray[np.int32]
    walls: npt.NDArray[np.int32]
    boundary_vertices: npt.NDArray[np.int32]
    background_vertex: npt.NDArray[np.int64]
    background_tet: npt.NDArray[np.int64]
    h: float
    notices: list[str]
    certificate: Optional[dict[str, Any]]

    def __init__(self, core: _core.Mesh):
        self._core = core
        for name in ("points", "tets", "boundary", "walls", "boundary_vertices", "background_vertex", "background_tet", "h",
                     "notices", "certificate"):
            setattr(self, name, getattr(core, name))

    @property
    def certified(self) -> bool:
        """True if the certificate passes; otherwise certificate["reasons"] lists the reasons."""
        return self.certificate is not None and bool(self.certificate["verdict"].startswith("pass"))

    @property
    def cells_dict(self) -> dict[str, npt.NDArray[np.int32]]:
        """Tets and boundary faces, including walls, by the names of meshio: tetra and triangle, or tetra10, triangle6."""
        faces = np.concatenate(list(self.patches().values()))
        return {_CELL_NAMES[self.tets.shape[1]]: self.tets, _CELL_NAMES[faces.shape[1]]: faces}

    def patches(self, **parameters: Any) -> dict[str, npt.NDArray[np.int32]]:
        """Returns the boundary faces of each patch: boundary, or boundary_1, boundary_2 ... if there are several pieces;
        walls; closed_holes.

        patch_angle=30 divides the boundary into region_1 ... along edges at which faces meet at more than 30 degrees.
        patch_planar=1 makes patches plane_1 ... of faces that are flat within 1 degree, and rest.
        """
        return self._core.patches(settings((), parameters, output=PATCHES))

    def save(self, path: Union[str, "os.PathLike[str]"]) -> None:
        """Writes .vtu (with ids and quality), .msh (Gmsh), .mesh (MEDIT), or .stl (the boundary).

        If the certificate lists closed_holes, .msh and .mesh contain a patch of this name (MEDIT: number 3).
        """
        self._core.save(path)

    def to_meshio(self, **parameters: Any) -> Any:
        """Returns a meshio.Mesh of the tets, with a block of faces and a cell set for each patch. Takes the parameters of
        patches()."""
        import meshio  # type: ignore[import]
        patches = self.patches(**parameters)
        cells = [(_CELL_NAMES[self.tets.shape[1]], self.tets)]
        cells += [(_CELL_NAMES[faces.shape[1]], faces) for faces in patches.values()]
        none = np.empty(0, int)
        sets = {
            name: [np.arange(len(faces)) if k == block else none for k in range(len(cells))]
            for block, (name, faces) in enumerate(patches.items(), 1)
        }
        return meshio.Mesh(self.points, cells, point_data={"background_vertex": self.background_vertex}, cell_sets=sets)

    def to_vtk(self) -> Any:
        """Returns a vtkUnstructuredGrid of the tets, with background_vertex and background_tet."""
        from vtkmodules.util.numpy_support import numpy_to_vtk, numpy_to_vtkIdTypeArray  # type: ignore[import]
        from vtkmodules.vtkCommonCore import vtkPoints  # type: ignore[import]
        from vtkmodules.vtkCommonDataModel import vtkCellArray, vtkUnstructuredGrid  # type: ignore[import]
        m, k = self.tets.shape
        points, cells, grid = vtkPoints(), vtkCellArray(), vtkUnstructuredGrid()
        points.SetData(numpy_to_vtk(self.points, deep=True))
        offsets = np.arange(0, k * (m + 1), k, dtype=np.int64)
        cells.SetData(numpy_to_vtkIdTypeArray(offsets, deep=True),
                      numpy_to_vtkIdTypeArray(self.tets.astype(np.int64).ravel(), deep=True))
        grid.SetPoints(points)
        grid.SetCells(_VTK_TETS[k], cells)
        for data, name in ((grid.GetPointData(), "background_vertex"), (grid.GetCellData(), "background_tet")):
            array = numpy_to_vtk(getattr(self, name), deep=True)
            array.SetName(name)
            data.AddArray(array)
        return grid

    def to_pyvista(self) -> Any:
        """Returns to_vtk() as a pyvista.UnstructuredGrid."""
        import pyvista  # type: ignore[import]
        return pyvista.wrap(self.to_vtk())

    def __repr__(self) -> str:
        return f"<umtet.Mesh: {len(self.tets)} tets, {len(self.points)} vertices, h = {self.h:.4g}>"


class Update:
    """The mesh at one instant, and the changes since the last: vertices_entered, vertices_left, vertices_moved,
    tets_entered and tets_left are background ids in ascending order."""
    mesh: Mesh
    vertices_entered: npt.NDArray[np.int64]
    vertices_left: npt.NDArray[np.int64]
    vertices_moved: npt.NDArray[np.int64]
    tets_entered: npt.NDArray[np.int64]
    tets_left: npt.NDArray[np.int64]

    def __init__(self, core: _core.Mesh, changes: dict[str, npt.NDArray[np.int64]]):
        self.mesh = Mesh(core)
        self.__dict__.update(changes)
