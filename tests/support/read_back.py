"""What meshio finds in mesh files, a JSON document a file: numbers of nodes, tets and faces, the area of every patch by
its number, names with their numbers, sizes of node sets, how many numbers of floating point data are known and their sum, and whether
every middle lies in the middle of its edge."""

import contextlib
import io
import json
import sys

import meshio
import numpy as np

EDGES = {"tetra10": [(0, 1), (1, 2), (2, 0), (0, 3), (1, 3), (2, 3)], "triangle6": [(0, 1), (1, 2), (2, 0)]}
TAGS = ["gmsh:geometrical", "medit:ref", "nastran:ref", "patch"]


def read_back(path):
    with contextlib.redirect_stdout(io.StringIO()), contextlib.redirect_stderr(io.StringIO()):
        mesh = meshio.read(path)
    x = mesh.points
    found = {"points": len(x), "tets": 0, "faces": 0, "area": {}, "middles": True}
    tags = next((mesh.cell_data[t] for t in TAGS if t in mesh.cell_data), None)
    for b, block in enumerate(mesh.cells):
        ids = block.data
        if block.type.startswith("tetra"):
            found["tets"] += len(ids)
        elif block.type.startswith("triangle"):
            found["faces"] += len(ids)
            corners = x[ids[:, :3]]
            area = np.linalg.norm(np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0]), axis=1) / 2
            for tag in np.unique(tags[b]) if tags is not None else []:
                key = str(int(tag))
                found["area"][key] = found["area"].get(key, 0) + float(area[tags[b] == tag].sum())
        for k, (p, q) in enumerate(EDGES.get(block.type, [])):
            middle = x[ids[:, len(block.data[0]) - len(EDGES[block.type]) + k]]
            found["middles"] &= bool(np.allclose(middle, (x[ids[:, p]] + x[ids[:, q]]) / 2, rtol=0, atol=1e-9))
    found["names"] = {k: int(np.ravel(v)[0]) for k, v in mesh.field_data.items()}
    found["node_sets"] = {k: len(v) for k, v in mesh.point_sets.items()}
    found["floats"] = {}
    for name, values in mesh.point_data.items():
        if values.dtype == np.uint8:
            found["node_sets"][name] = int(values.sum())
        elif values.dtype == np.float64:
            known = values[~np.isnan(values)]
            found["floats"][name] = {"known": len(known), "sum": float(known.sum())}
    return found


for path in sys.argv[1:]:
    print(json.dumps(read_back(path)))
