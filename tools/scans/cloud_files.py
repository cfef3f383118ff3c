"""Clouds and triangle meshes in files: PLY, XYZ and PCD are read, PLY is written."""
import pathlib

import numpy as np

TYPES = {"float": "f4", "float32": "f4", "double": "f8", "float64": "f8", "uchar": "u1", "uint8": "u1", "int": "i4",
         "int32": "i4", "uint": "u4", "short": "i2", "ushort": "u2", "char": "i1"}
REFERENCE = {"penguin_flipped_normals": "penguin", "cat_no_normals": "cat", "spot_ascii": "spot",
             "bunny_holes": "bunny_zipper", "bunny_scans": "bunny_zipper"}
SUFFIXES = (".ply", ".xyz", ".pcd")


def points_and_normals(table, names, normal_names=("nx", "ny", "nz")):
    normals = table[:, [names.index(k) for k in normal_names]] if normal_names[0] in names else None
    return table[:, [names.index(k) for k in "xyz"]], normals


def read_ply(file):
    """Points, normals or None, triangles or None."""
    with open(file, "rb") as f:
        data = f.read()
    end = data.index(b"end_header") + len(b"end_header")
    header = data[:end].decode().split("\n")
    body = data[data.index(b"\n", end - 1) + 1:]
    elements, swap = [], "<"
    for line in header:
        words = line.split()
        if line.startswith("format"):
            swap = {"ascii": None, "binary_little_endian": "<", "binary_big_endian": ">"}[words[1]]
        if line.startswith("element"):
            elements.append((words[1], int(words[2]), []))
        if line.startswith("property"):
            elements[-1][2].append(words[1:])
    name, n, properties = elements[0]
    assert name == "vertex"
    names = [p[-1] for p in properties]
    if swap is None:
        rows = body.decode().split("\n")
        table = np.array([r.split()[:len(names)] for r in rows[:n]], float)
        faces = [r.split() for r in rows[n:] if r.strip()]
        triangles = np.array([f[1:4] for f in faces], int) if len(elements) > 1 and faces else None
    else:
        vertex = np.dtype([(p[-1], swap + TYPES[p[0]]) for p in properties])
        table = np.frombuffer(body, vertex, n)
        table = np.stack([table[k].astype(float) for k in names], 1)
        triangles = None
        if len(elements) > 1 and len(elements[1][2]) == 1 and elements[1][1] > 0:
            kinds = elements[1][2][0]
            face = np.dtype([("n", TYPES[kinds[1]]), ("v", swap + TYPES[kinds[2]], 3)])
            triangles = np.frombuffer(body, face, elements[1][1], n * vertex.itemsize)["v"].astype(int)
    return *points_and_normals(table, names), triangles


def read_pcd(file):
    """Points, and normals or None; not compressed, every field one number."""
    with open(file, "rb") as f:
        data = f.read()
    end = data.index(b"\n", data.index(b"\nDATA ") + 1) + 1
    words = {line.split()[0]: line.split()[1:] for line in data[:end].decode().splitlines() if line and line[0] != "#"}
    names, n = words["FIELDS"], int(words["POINTS"][0])
    if words["DATA"] == ["ascii"]:
        table = np.array(data[end:].split(), float).reshape(n, len(names))
    elif words["DATA"] == ["binary"]:
        types = np.dtype([(k, "<" + t.lower() + s) for k, t, s in zip(names, words["TYPE"], words["SIZE"])])
        rows = np.frombuffer(data, types, n, end)
        table = np.stack([rows[k].astype(float) for k in names], 1)
    else:
        raise ValueError(f"{file}: DATA {words['DATA']} is not read")
    return points_and_normals(table, names, ("normal_x", "normal_y", "normal_z"))


def read_cloud(file):
    """Points, and normals or None."""
    suffix = pathlib.Path(file).suffix
    if suffix == ".ply":
        return read_ply(file)[:2]
    if suffix == ".pcd":
        return read_pcd(file)
    table = np.loadtxt(file)
    return table[:, :3], table[:, 3:6] if table.shape[1] >= 6 else None


def reference_of(file, folders=()):
    """The true mesh of a cloud: in one of the folders, or in reference/ beside it; or None."""
    file = pathlib.Path(file)
    meshes = [pathlib.Path(folder) / (REFERENCE.get(file.stem, file.stem) + ".ply")
              for folder in (*folders, file.parent / "reference")]
    return next((mesh for mesh in meshes if mesh.exists()), None)


def write_ply(file, points, normals=None, kind="double"):
    table = points if normals is None else np.hstack([points, normals])
    names = ["x", "y", "z", "nx", "ny", "nz"][:table.shape[1]]
    with open(file, "wb") as f:
        f.write((f"ply\nformat binary_little_endian 1.0\nelement vertex {len(points)}\n"
                 + "".join(f"property {kind} {k}\n" for k in names) + "end_header\n").encode())
        f.write(np.ascontiguousarray(table, "<" + TYPES[kind]).tobytes())
