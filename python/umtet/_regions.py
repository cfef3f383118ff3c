"""The result of umtet.mesh_regions()."""
import os
from typing import Any, Union

import numpy as np
import numpy.typing as npt

from . import _core


class RegionsMesh:
    """One mesh of several bodies, in which tets on both sides of an interface share its faces.

    points: (n, 3) float64. tets: (m, 4) indices into points, with positive orientation.
    region: (m,) of each tet: 0 outside, then 1, 2 ... in the order of the bodies. names: of the regions, names[0] is
    "outside". h: the mean edge length of the background.
    certificate: a dict with the contents of regions.json.
    """
    points: npt.NDArray[np.float64]
    tets: npt.NDArray[np.int32]
    region: npt.NDArray[np.int32]
    names: list[str]
    h: float
    certificate: dict[str, Any]

    def __init__(self, core: _core.RegionsMesh):
        self._core = core
        for name in ("points", "tets", "region", "names", "h", "certificate"):
            setattr(self, name, getattr(core, name))

    @property
    def certified(self) -> bool:
        """True if the certificate passes; otherwise certificate["reasons"] lists the reasons."""
        return bool(self.certificate["verdict"] == "pass")

    def patches(self) -> dict[str, npt.NDArray[np.int32]]:
        """Returns the faces (k, 3) of each interface, such as "bone|marrow", and of the boundary: walls, or "bone|outside"
        without an outside. Normals point out of the region that is named first."""
        return self._core.patches()

    def save(self, path: Union[str, "os.PathLike[str]"]) -> None:
        """Writes .vtu, .msh (Gmsh), .mesh (MEDIT), .inp (Abaqus, CalculiX), .bdf, .feb or .cdb, with a part for each region
        and a set for each patch."""
        self._core.save(path)

    def __repr__(self) -> str:
        return f"<umtet.RegionsMesh: {len(self.tets)} tets, {len(self.names)} regions, h = {self.h:.4g}>"
