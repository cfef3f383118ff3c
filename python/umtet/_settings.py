"""Converts keyword arguments to parameters of the program."""
import os
from typing import Any, Iterable, Mapping, Optional, Sequence

import numpy as np
import numpy.typing as npt

from . import _core

Settings = list[tuple[str, str]]

_KEYS: dict[str, dict[str, str]] = {}  # for each section, the parameter of each keyword argument: mesh.h is h of mesh()
for _key in _core.parameters():
    _section, _name = _key.split(".")
    _KEYS.setdefault(_section, {})[_name] = _key
for _name in ("implicit", "keep_iterates"):  # only for the program
    _KEYS["mesh"].pop(_name, None)
for _name in ("file", "orient_from", "features"):
    _KEYS["cloud"].pop(_name, None)
_OUTPUT = ("units", "max_memory", "min_quality", "strict", "accept")
PATCHES = ("patch_angle", "patch_planar")


def _text(value: Any) -> str:
    if isinstance(value, (bool, np.bool_)):
        return "true" if value else "false"
    if isinstance(value, (float, np.floating)):
        return repr(float(value))
    if isinstance(value, (list, tuple, np.ndarray)):
        return ",".join(_text(v) for v in np.ravel(value).tolist())
    return str(os.fspath(value)) if isinstance(value, os.PathLike) else str(value)


def settings(sections: Sequence[str], arguments: Mapping[str, Any], without: Iterable[str] = (),
             output: Sequence[str] = _OUTPUT) -> Settings:
    """Converts keyword arguments to parameters of pipeline/case/parameters.def."""
    known = {name: key for s in sections for name, key in _KEYS[s].items() if name not in without}
    known.update({name: "output." + name for name in output if "output." + name in _core.parameters()})
    made = []
    for name, value in arguments.items():
        if value is None:
            continue
        if name not in known:
            raise TypeError(f"there is no parameter {name!r}; there are {', '.join(sorted(known))}")
        made.append((known[name], _text(value)))
    return made


def box_of(box: Optional[npt.ArrayLike]) -> Optional[npt.NDArray[np.float64]]:
    """Returns a box as (x0, y0, z0, x1, y1, z1). It may be given as these numbers or as two corners."""
    if box is None:
        return None
    numbers = np.asarray(box, float)
    if numbers.size != 6:
        raise ValueError("box must be six numbers, x0, y0, z0, x1, y1, z1")
    return numbers.ravel()
