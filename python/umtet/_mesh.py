"""Meshes as their users hold them."""
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

    points (n, 3) float64; tets (m, 4), positive; boundary (k, 3), counter-clockwise from outside; walls (w, 3), the faces
    at the walls of the box (complement=True); boundary_vertices;
    background_vertex (n,), background_tet (m,): ids in the universal mesh; h, its mean edge length; certificate, the
    keys of certificate.json but for `run` and the checksum; notices, what was done to a grid.

    Of mesh(order=2): tets (m, 10), the corners, then the middles of 01 12 20 03 13 23 as VTK has them; boundary (k, 6),
    the corners, then the middles of 01 12 20; mid-sides come behind the corners in points and have background_vertex -1.
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
        """True if nothing is wrong with it; certificate["reasons"] lists what is."""
        return self.certificate is not None and bool(self.certificate["verdict"].startswith("pass"))

    @property
    def cells_dict(self) -> dict[str, npt.NDArray[np.int32]]:
        """Tets and boundary faces, walls among them, by meshio's names: tetra and triangle, or tetra10 and triangle6."""
        faces = np.concatenate(list(self.patches().values()))
        return {_CELL_NAMES[self.tets.shape[1]]: self.tets, _CELL_NAMES[faces.shape[1]]: faces}

    def patches(self, **parameters: Any) -> dict[str, npt.NDArray[np.int32]]:
        """Boundary faces by name: boundary, or boundary_1, boundary_2 ... if they are several pieces; walls, closed_holes.

        patch_angle=30: region_1 ..., which end where faces meet at more degrees. patch_planar=1: plane_1 ..., what is
        flat within so many, and rest.
        """
        return self._core.patches(settings((), parameters, output=PATCHES))

    def save(self, path: Union[str, "os.PathLike[str]"]) -> None:
        """Writes .vtu (with ids and quality), .msh (Gmsh), .mesh (MEDIT), or .stl (the boundary).

        Where the certificate lists closed_holes, .msh and .mesh have them as the patch of that name (MEDIT: number 3).
        """
        self._core.save(path)

    def to_meshio(self, **parameters: Any) -> Any:
        """A meshio.Mesh: the tets, and a block of faces and a cell set for each patch. Parameters: those of patches()."""
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
        """A vtkUnstructuredGrid of the tets, with background_vertex and background_tet."""
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
        """The same as a pyvista.UnstructuredGrid."""
        import pyvista  # type: ignore[import]
        return pyvista.wrap(self.to_vtk())

    def __repr__(self) -> str:
        return f"<umtet.Mesh: {len(self.tets)} tets, {len(self.points)} vertices, h = {self.h:.4g}>"


class Update:
    """The mesh at one time, and what is new since the last: vertices_entered, vertices_left, vertices_moved,
    tets_entered, tets_left, background ids in ascending order."""
    mesh: Mesh
    vertices_entered: npt.NDArray[np.int64]
    vertices_left: npt.NDArray[np.int64]
    vertices_moved: npt.NDArray[np.int64]
    tets_entered: npt.NDArray[np.int64]
    tets_left: npt.NDArray[np.int64]

    def __init__(self, core: _core.Mesh, changes: dict[str, npt.NDArray[np.int64]]):
        self.mesh = Mesh(core)
        self.__dict__.update(changes)
