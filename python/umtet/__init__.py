"""From oriented points, or a level set psi < 0 inside, to certified tetrahedral meshes.

    reconstruct(points, normals)  -> LevelSet     a C2 level set psi of a point cloud
    mesh(psi, ...)                -> Mesh         a boundary-fitting mesh of {psi < 0}, with its certificate
    UniversalMesh(box, h).update(psi) -> Update   the same for a domain that moves, in one background mesh
    certificate(points, tets)     -> dict         what is true of any tet mesh

psi is a LevelSet, a formula such as "x^2+y^2+z^2-1", or a callable: f(points) is given an array (n, 3) and returns
values (n,), or (values, gradients (n, 3)), or (values, gradients, hessians (n, 3, 3)). What it does not return is made
of central differences. The mesher asks point by point: a callable costs some microseconds a value and keeps the mesher
to one thread; level sets and formulas are evaluated in C++, by all threads, without the GIL.

Keyword arguments beyond those named are the parameters of `umtet run --help` and case.toml: mesh(psi, mode="paper").
A progress callback is called as progress(step, fraction), mostly from another thread; when it returns False the work is
stopped with Cancelled.
Ctrl-C stops it with KeyboardInterrupt.

ValueError: a broken contract, such as a parameter out of range. MeshingError and ReconstructionError: what was asked for
is not possible; their `evidence` is a dict with status, places and lengths. A mesh whose certificate fails is returned:
look at `mesh.certified`.
"""
import os

import numpy as np

from . import _core
from ._core import Cancelled, LevelSet, MeshingError, ReconstructionError

__version__ = _core.__version__
__all__ = [
    "Cancelled", "LevelSet", "Mesh", "MeshingError", "ReconstructionError", "UniversalMesh", "Update", "certificate",
    "mesh", "reconstruct"
]

for _error in (Cancelled, MeshingError, ReconstructionError):
    _error.__module__ = "umtet"  # as they are printed

_KEYS = {}  # of a keyword argument, by section: mesh.h is h of mesh()
for _key in _core.parameters():
    _section, _name = _key.split(".")
    _KEYS.setdefault(_section, {})[_name] = _key
for _name in ("implicit", "keep_iterates"):  # of the program
    _KEYS["mesh"].pop(_name, None)
for _name in ("file", "orient_from"):
    _KEYS["cloud"].pop(_name, None)
_OUTPUT = ("units", "max_memory", "min_quality", "strict", "accept")
_NOT_OF_A_MOVING_MESH = ("tets", "max_tets", "max_deviation", "effort", "order")


def _text(value):
    if isinstance(value, (bool, np.bool_)):
        return "true" if value else "false"
    if isinstance(value, (float, np.floating)):
        return repr(float(value))
    if isinstance(value, (list, tuple, np.ndarray)):
        return ",".join(_text(v) for v in np.ravel(value).tolist())
    return os.fspath(value) if isinstance(value, os.PathLike) else str(value)


def _settings(sections, arguments, without=()):
    """Keyword arguments as parameters of the table."""
    known = {name: key for s in sections for name, key in _KEYS[s].items() if name not in without}
    known.update({name: "output." + name for name in _OUTPUT if "output." + name in _core.parameters()})
    settings = []
    for name, value in arguments.items():
        if value is None:
            continue
        if name not in known:
            raise TypeError(f"there is no parameter {name!r}; there are {', '.join(sorted(known))}")
        settings.append((known[name], _text(value)))
    return settings


def _box(box):
    """(x0, y0, z0, x1, y1, z1), or two corners."""
    if box is None:
        return None
    box = np.asarray(box, float)
    if box.size != 6:
        raise ValueError("box: six numbers are wanted, x0, y0, z0, x1, y1, z1")
    return box.ravel()


def _value(self, points):
    """psi at points (n, 3): (n,). Model units, negative inside."""
    return self._evaluate(points, 0)


def _gradient(self, points):
    """Its gradients (n, 3)."""
    return self._evaluate(points, 1)


def _hessian(self, points):
    """Its Hessians (n, 3, 3)."""
    return self._evaluate(points, 2)


LevelSet.value, LevelSet.gradient, LevelSet.hessian = _value, _gradient, _hessian


def reconstruct(points, normals=None, *, normal_source=None, progress=None, threads=0, **parameters):
    """Fits a C2 level set to a point cloud, as `umtet reconstruct` does.

    points (n, 3), 30 at least; normals (n, 3) outward, of any length, or None: estimated and oriented. Outliers and
    duplicates are dropped (keep_all=True keeps outliers), a minority of turned normals is turned back (not with
    normal_source="given"); `report["notices"]` says what was done. Parameters: spacing, detail, smooth, noise, flip, ...

    Returns a LevelSet: value(points), gradient(points), hessian(points), box (2, 3), points and normals that were used,
    report, save("level_set.vti"). ReconstructionError: the samples do not bound a body, or it would not fit in memory.
    """
    if isinstance(points, (str, os.PathLike)):
        raise TypeError("points: an array (n, 3) is wanted; files are read by `umtet run`")
    parameters["normals"] = normal_source
    return _core.reconstruct(points, normals, _settings(("cloud", "reconstruct"), parameters), progress, threads)


class Mesh:
    """A tet mesh that fits {psi = 0}, with the ids of its background.

    points (n, 3) float64; tets (m, 4), positive; boundary (k, 3), counter-clockwise from outside; walls (w, 3), the faces
    at the walls of the box (complement=True); boundary_vertices;
    background_vertex (n,), background_tet (m,): ids in the universal mesh; h, its mean edge length; certificate, the
    keys of certificate.json but for `run` and the checksum.

    Of mesh(order=2): tets (m, 10), the corners, then the middles of 01 12 20 03 13 23 as VTK has them; boundary (k, 6),
    the corners, then the middles of 01 12 20; mid-sides come behind the corners in points and have background_vertex -1.
    """

    def __init__(self, core):
        self._core = core
        for name in ("points", "tets", "boundary", "walls", "boundary_vertices", "background_vertex", "background_tet", "h",
                     "certificate"):
            setattr(self, name, getattr(core, name))

    @property
    def certified(self):
        """True if nothing is wrong with it; certificate["reasons"] lists what is."""
        return self.certificate is not None and self.certificate["verdict"] == "pass"

    def save(self, path):
        """Writes .vtu (with ids and quality), .msh (Gmsh), .mesh (MEDIT), or .stl (the boundary).

        Where the certificate lists closed_holes, .msh and .mesh have them as the patch of that name (MEDIT: number 3).
        """
        self._core.save(path)

    def __repr__(self):
        return f"<umtet.Mesh: {len(self.tets)} tets, {len(self.points)} vertices, h = {self.h:.4g}>"


def mesh(psi, *, box=None, t=None, progress=None, threads=0, **parameters):
    """Meshes {psi < 0}, as `umtet mesh` does.

    box: around the domain, with room of two edges; a LevelSet has its own. t: what t stands for in a formula. One of
    h, tets and max_deviation, or none (h from size and thickness). order=2: tets of 10 nodes with curved boundary, every
    Jacobian proved positive in the certificate. Other parameters: background="z", mode="paper",
    max_tets, min_quality, target_quality, seed, ...; complement=True with box_walls=True: {psi > 0} up to
    the flat walls of the box, the fluid around the body.

    Returns a Mesh, the best of up to five where the choice of h is left to umtet. MeshingError: there is none;
    evidence says where, and which h may do. Mesh.certified says whether what is there is right.
    """
    parameters["box"] = _box(box)
    return Mesh(_core.mesh(psi, _settings(("mesh",), parameters), t, progress, threads))


class Update:
    """The mesh at one time, and what is new since the last: vertices_entered, vertices_left, vertices_moved,
    tets_entered, tets_left, background ids in ascending order."""

    def __init__(self, core, changes):
        self.mesh = Mesh(core)
        self.__dict__.update(changes)


class UniversalMesh:
    """Meshes of a domain that moves inside `box`, all in one background mesh of edge length h.

    Parameters are those of mesh() in fast mode: background="z", target_quality, complement and box_walls, ...
    """

    def __init__(self, box, h, **parameters):
        self._core = _core.Moving(_settings(("mesh",), {**parameters, "box": _box(box), "h": h}, _NOT_OF_A_MOVING_MESH))

    @property
    def h(self):
        return self._core.h

    @property
    def n_background_vertices(self):
        """Size of the range of background vertex ids."""
        return self._core.n_vertices

    def update(self, psi, *, t=None, seeds=None, certify=False, progress=None, threads=0):
        """The mesh of {psi < 0}, from the one before.

        seeds (k, 3): a point near each component that is new. certify: the mesh gets its certificate, for about the
        time of a mesh (else it is None). MeshingError leaves the last mesh as what the next update starts from.
        """
        return Update(*self._core.update(psi, t, seeds, certify, progress, threads))


def certificate(points, tets, psi=None, *, h=0, t=None, **parameters):
    """What is true of any tet mesh: exact signs of all volumes, boundary, quality; with psi also distances to psi = 0.

    points (n, 3), tets (m, 4). h is what ratios refer to (0: the mesh's own edge length). Parameters: min_quality.
    Returns a dict with keys of certificate.json: n_tets, volume, quality, boundary, gates, verdict, reasons.
    """
    tets = np.asarray(tets)
    if tets.dtype.kind not in "iu":
        raise TypeError(f"tets: an array of integers is wanted, not of {tets.dtype}")
    return _core.certificate(points, tets, psi, _settings((), parameters), t, h)
