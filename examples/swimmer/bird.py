#!/usr/bin/python3
"""Section 4.1 of the paper: clouds of a bird in flight, eq. (12), and their meshes in one background mesh.

usage: examples/swimmer/bird.py [--umtet PROGRAM] [-o FOLDER] [--t FROM:STEP:TO] [FLAG OF umtet evolve ...]

Writes FOLDER/clouds/bird_0000.ply ... and FOLDER/clouds/list, then calls `umtet evolve` for FOLDER/meshes. The paper does
not say at which times its bird was meshed: the default is one period, 0:0.4:6. Needs Debian's python3-numpy.
"""
import argparse
import subprocess
import sys
from pathlib import Path

import numpy as np

ROOT = Path(__file__).resolve().parent.parent.parent


def read_bird(path):
    """The header, and x y z nx ny nz of each point."""
    data = path.read_bytes()
    begin = data.index(b"end_header\n") + len(b"end_header\n")
    return data[:begin], np.frombuffer(data[begin:], "<f8").reshape(-1, 6)


def moved(points, t):
    """Eq. (12). With F = I + e_y g^T, g the gradient of the displacement, normals move by F^-T n = n - n_y g."""
    x, y, z, nx, ny, nz = points.T
    y = y + .8 * (np.cos(x) - 1) * np.sin(t) + .1 * np.sin(z) * np.cos(t)
    n = np.array([nx + .8 * np.sin(x) * np.sin(t) * ny, ny, nz - .1 * np.cos(z) * np.cos(t) * ny])
    return np.vstack([x, y, z, n / np.linalg.norm(n, axis=0)]).T


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--umtet", default=ROOT / "build/release/pipeline/umtet")
    parser.add_argument("-o", dest="folder", type=Path, default=Path("bird"))
    parser.add_argument("--t", default="0:0.4:6")
    options, flags = parser.parse_known_args()
    first, step, last = (float(part) for part in options.t.split(":"))
    clouds = options.folder / "clouds"
    clouds.mkdir(parents=True, exist_ok=True)
    header, points = read_bird(ROOT / "data/clouds/bird.ply")
    names = []
    for k in range(int((last - first) / step + 1e-9) + 1):
        names.append(f"bird_{k:04}.ply")
        (clouds / names[-1]).write_bytes(header + moved(points, first + k * step).astype("<f8").tobytes())
    (clouds / "list").write_text("\n".join(names) + "\n")
    call = [options.umtet, "evolve", "--clouds", clouds / "list", f"--t={options.t}", "-o", options.folder / "meshes"]
    return subprocess.run(call + flags).returncode


if __name__ == "__main__":
    sys.exit(main())
