"""Whether a run came out right: expectations, and what is measured of the mesh file. No number of umtet is used."""
import pathlib
import re
from dataclasses import dataclass, field
from typing import NamedTuple

import numpy as np
from scipy.spatial import cKDTree

import tet_mesh

RIGHT, REFUSED, WRONG = "right", "refused as it should", "wrong"
GUESSED = .2  # share of the boundary without samples beyond which nothing is a plain pass (issue 45, line 2)
NEAR = 3  # spacings of samples within which the surface is seen


@dataclass
class Expected:
    """What is right of a file. What is None is not asked."""
    volume: float = None
    tolerance: float = .03  # of the volume
    genus: int = None  # of all pieces of the boundary together
    pieces: int = None  # of the boundary
    bodies: int = None  # pieces of tets
    tets: int = None  # at most
    seconds: float = None  # at most, of CPU
    box: tuple = None  # low and high corner; each side may be off by box_off
    box_off: float = 0
    flat: list = field(default_factory=list)  # (point, unit normal, radius): openings that are to be closed in a plane
    corners: np.ndarray = None  # points that sharp edges need among the vertices
    tight: float = None  # tolerance of the volume where sharp edges are kept
    samples: np.ndarray = None  # points that the boundary passes
    values: list = field(default_factory=list)  # (what, test of an array of point data): fields that the mesh carries
    codes: tuple = (0,)  # exit codes with a mesh that is judged
    refused: tuple = ()  # exit codes that are right in place of a mesh
    says: str = ""  # regular expression that the message of a refusal has
    note: str = ""


class Measured(NamedTuple):
    """Of a mesh file."""
    tets: int
    least_q: float
    volume: float
    bodies: int
    pieces: int
    genus: int
    points: np.ndarray
    faces: np.ndarray
    data: dict

    def edge(self):
        """Mean length of the edges of the boundary."""
        edges = tet_mesh.edges_of(self.faces)[0]
        return np.linalg.norm(self.points[edges[:, 0]] - self.points[edges[:, 1]], axis=1).mean()


def measured(mesh):
    faces = tet_mesh.boundary(mesh)
    around = tet_mesh.surface(faces)
    return Measured(len(mesh.tets), float(tet_mesh.mean_ratios(mesh).min()), float(tet_mesh.volume(mesh)),
                    tet_mesh.n_bodies(mesh), around.pieces, around.genus, mesh.points, faces, mesh.data)


def measured_case(case):
    """Of the mesh of a case; None where there is none."""
    file = pathlib.Path(case) / "3-mesh/mesh.vtu"
    return measured(tet_mesh.read(file)) if file.exists() else None


def guessed_share(m, samples):
    """Of the area of the boundary, what is farther from all samples than NEAR spacings: of the median of the distances
    to the sixth neighbour, over which a surface that is sampled evenly has about one and a half spacings."""
    tree = cKDTree(samples)
    some = samples[:: max(1, len(samples) // 5000)]
    spacing = np.quantile(tree.query(some, 7)[0][:, 6], .95) / 1.5
    a, b, c = (m.points[m.faces[:, k]] for k in range(3))
    area = np.linalg.norm(np.cross(b - a, c - a), axis=1)
    far = tree.query((a + b + c) / 3)[0] > NEAR * spacing
    return float(area[far].sum() / area.sum())


def flatness(m, opening):
    """Largest distance from the plane, in mean edges, of boundary vertices whose foot is within .8 of the radius and that
    are near the plane; None where there are none."""
    point, normal, radius = opening
    x = m.points[np.unique(m.faces)] - point
    height = x @ normal
    foot = np.linalg.norm(x - height[:, None] * normal, axis=1)
    over = np.abs(height[(foot < .8 * radius) & (np.abs(height) < radius)])
    return float(over.max() / m.edge()) if len(over) else None


def edges_kept(expected, m):
    """Of sharp bodies: whether corners are vertices (within a twentieth of an edge) and the volume is as tight; None of
    others."""
    if expected.corners is None and expected.tight is None:
        return None
    off = 0
    if expected.corners is not None:
        off = cKDTree(m.points[np.unique(m.faces)]).query(expected.corners)[0].max() / m.edge()
    tight = expected.tight is None or abs(m.volume / expected.volume - 1) <= expected.tight
    return bool(off <= .05 and tight)


def faults_of_mesh(expected, m, is_plain_pass=True):
    """Sentences; none where the mesh is right."""
    found = []
    if expected.volume is not None and abs(m.volume / expected.volume - 1) > expected.tolerance:
        found.append(f"volume {100 * (m.volume / expected.volume - 1):+.2f} %")
    for name in ("genus", "pieces", "bodies"):
        wanted, got = getattr(expected, name), getattr(m, name)
        if wanted is not None and got != wanted:
            found.append(f"{name} {got}, not {wanted}")
    if m.genus is None:
        found.append("the boundary is no manifold")
    if m.least_q <= 0:
        found.append("inverted tets")
    if expected.tets is not None and m.tets > expected.tets:
        found.append(f"{m.tets} tets, over {expected.tets}")
    if expected.box is not None:
        x = m.points[np.unique(m.faces)]
        off = max(np.abs(x.min(0) - expected.box[0]).max(), np.abs(x.max(0) - expected.box[1]).max())
        if off > max(expected.box_off, .3 * m.edge()):
            found.append(f"the box is off by {off:.3g}")
    for k, opening in enumerate(expected.flat):
        off = flatness(m, opening)
        if off is None or off > .3:
            found.append(f"opening {k + 1} is " + ("not there" if off is None else f"{off:.2f} edges off its plane"))
    for what, test in expected.values:
        known = [np.asarray(array, float) for array in m.data.values()]
        known = [a[np.isfinite(a.reshape(len(a), -1)).all(1)] for a in known]  # NaN inside
        if not any(len(a) > 0 and test(a) for a in known):
            found.append(f"no field of {what}")
    if expected.samples is not None:
        share = guessed_share(m, expected.samples)
        if share > GUESSED and is_plain_pass:
            found.append(f"{100 * share:.0f} % of the boundary is guessed, and it is a plain pass")
    return found


class Judgement(NamedTuple):
    result: str
    edges: str  # "kept", "lost", or empty where there are none
    reason: str


def judge(expected, code, seconds, says, m, is_plain_pass=True):
    """Of one run.
    @param says           the messages of the program and the reasons of its certificate
    @param m              Measured of its mesh, or None
    @param is_plain_pass  exit 0 and no defect named"""
    late = expected.seconds is not None and seconds > expected.seconds
    slow = [f"{seconds:.1f} s, over {expected.seconds:g}"] if late else []
    if code in expected.refused and not (code in expected.codes and m is not None):
        silent = [] if re.search(expected.says, says) else [f"the message does not say /{expected.says}/"]
        return Judgement(WRONG if slow or silent else REFUSED, "", "; ".join(slow + silent))
    if code not in expected.codes:
        return Judgement(WRONG, "", "; ".join([f"exit {code}", *slow]))
    if m is None:
        return Judgement(WRONG, "", "no mesh")
    found = faults_of_mesh(expected, m, is_plain_pass) + slow
    kept = edges_kept(expected, m)
    return Judgement(WRONG if found else RIGHT, "" if kept is None else "kept" if kept else "lost", "; ".join(found))
