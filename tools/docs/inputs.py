#!/usr/bin/python3
"""inputs.png: what people have, each with its one command, and the meshes that come of it.

usage: PYTHONPATH=build/release/python xvfb-run -a tools/docs/inputs.py UMTET [PICTURE]

Makes an STL of a duck, a PCD of two views of it, an array of numpy and a NIfTI mask, runs the commands of
docs/using.md, and prints one line for each. Needs Debian's python3-vtk9, python3-pil, fonts-dejavu-core, xvfb and
libgl1-mesa-dri.
"""
import json
import pathlib
import struct
import subprocess
import sys
import tempfile
import time

import numpy as np
import umtet
from PIL import Image, ImageDraw, ImageFont

HERE = pathlib.Path(__file__).resolve().parent
ROOT = HERE.parents[1]
SIZE = (850, 350)  # of a panel


def duck():
    """Points and normals of data/clouds/duck.ply."""
    data = (ROOT / "data/clouds/duck.ply").read_bytes()
    head, _, body = data.partition(b"end_header\n")
    names = [line.split()[1:] for line in head.decode().splitlines() if line.startswith("property")]
    kind = {"float": "<f4", "double": "<f8"}
    rows = np.frombuffer(body, np.dtype([(name, kind[t]) for t, name in names]))
    return (np.stack([rows[a] for a in axes], 1).astype(float) for axes in ("xyz", ("nx", "ny", "nz")))


def stl(umtet_program, folder):
    """The boundary of a mesh of the duck, as another program would have it."""
    run([umtet_program, "run", ROOT / "data/clouds/duck.ply", "-o", folder / "whole", "--export", "stl"])
    [file] = (folder / "whole").rglob("*.stl")
    (folder / "duck.stl").write_bytes(file.read_bytes())


def pcd(folder):
    """Two views, without normals: the samples that look to one of two scanners, each with the place of its scanner."""
    points, normals = duck()
    size = np.linalg.norm(np.ptp(points, 0))
    rows = []
    for place in points.mean(0) + size * np.array([[1.5, .4, .3], [-1.5, .4, .3]]):
        sight = place - points
        seen = (normals * sight).sum(1) > .1 * np.linalg.norm(sight, axis=1)
        rows += [np.hstack([points[seen], np.broadcast_to(place, (seen.sum(), 3))])]
    rows = np.vstack(rows).astype("<f4")
    head = f"""VERSION .7
FIELDS x y z sx sy sz
SIZE 4 4 4 4 4 4
TYPE F F F F F F
COUNT 1 1 1 1 1 1
WIDTH {len(rows)}
HEIGHT 1
VIEWPOINT 0 0 0 1 0 0 0
POINTS {len(rows)}
DATA binary
"""
    (folder / "two_views.pcd").write_bytes(head.encode() + rows.tobytes())


def nifti(folder):
    """A mask of a hollow bean, 1 where a voxel is in it."""
    n = 64
    x = np.stack(np.meshgrid(*[np.linspace(-1.3, 1.3, n)] * 3, indexing="ij"))
    bent = np.sqrt((x[0] + .5 * x[2] ** 2 - .2) ** 2 + x[1] ** 2 + (.7 * x[2]) ** 2)
    mask = ((bent < .75) & ~((x[0] - .1) ** 2 + x[2] ** 2 < .06)).astype(np.uint8)
    head = bytearray(352)
    struct.pack_into("<i", head, 0, 348)
    struct.pack_into("<8h", head, 40, 3, n, n, n, 1, 1, 1, 1)
    struct.pack_into("<2h", head, 70, 2, 8)
    struct.pack_into("<8f", head, 76, 1, .04, .04, .04, 1, 1, 1, 1)
    struct.pack_into("<f", head, 108, 352)
    head[344:348] = b"n+1\0"
    (folder / "mask.nii").write_bytes(bytes(head) + mask.tobytes("F"))


def psi(x):
    """Two rings, linked."""
    a = np.hypot(np.hypot(x[:, 0] + .5, x[:, 1]) - 1, x[:, 2]) - .25
    b = np.hypot(np.hypot(x[:, 0] - .5, x[:, 2]) - 1, x[:, 1]) - .25
    return np.minimum(a, b)


def run(command, **more):
    subprocess.run([str(word) for word in command], check=True, capture_output=True, **more)


def panel(mesh, up, caption, folder):
    file = folder / "panel.png"
    run([sys.executable, HERE / "render.py", mesh, file, "--up", up])
    picture = Image.open(file).convert("RGB").resize(SIZE)
    ImageDraw.Draw(picture).text((12, SIZE[1] - 34), caption, fill="black",
                                  font=ImageFont.truetype("DejaVuSans.ttf", 20))
    return picture


def line(caption, seconds, certificate):
    print(f"{caption}: {seconds:.1f} s, {certificate['n_tets']:,} tets, min Q {certificate['quality']['min']:.3f}, "
          f"{certificate['verdict']}")


def main():
    program = pathlib.Path(sys.argv[1]).resolve()
    picture = pathlib.Path(sys.argv[2] if len(sys.argv) > 2 else ROOT / "docs/inputs.png")
    with tempfile.TemporaryDirectory() as temporary:
        folder = pathlib.Path(temporary)
        stl(program, folder), pcd(folder), nifti(folder)
        panels = []
        for words, up in (("run duck.stl", "y"), ("run two_views.pcd", "y"), ("mesh --level-set mask.nii", "z")):
            begin = time.monotonic()
            run([program, *words.split(), "-o", "case", "--force"], cwd=folder)
            seconds = time.monotonic() - begin
            line(f"umtet {words}", seconds, json.loads((folder / "case/certificate.json").read_text()))
            panels.append(panel(folder / "case/3-mesh/mesh.vtu", up, f"umtet {words}", folder))
        begin = time.monotonic()
        mesh = umtet.mesh(psi, box=(-2, -1.7, -1.7, 2, 1.7, 1.7), tets=100000)
        line("umtet.mesh(psi, ...)", time.monotonic() - begin, dict(mesh.certificate))
        mesh.save(str(folder / "rings.vtu"))
        panels.append(panel(folder / "rings.vtu", "z", "umtet.mesh(psi, ...)", folder))
    whole = Image.new("RGB", (2 * SIZE[0], 2 * SIZE[1]), "white")
    for i, one in enumerate(panels):
        whole.paste(one, (i % 2 * SIZE[0], i // 2 * SIZE[1]))
    whole.save(picture, optimize=True)


if __name__ == "__main__":
    main()
