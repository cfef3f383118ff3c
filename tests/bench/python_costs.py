#!/usr/bin/python3
"""What a psi of Python costs: the table of python/README.md. CPU of one core for the unit ball, the least of REPEATS.

usage: PYTHONPATH=FOLDER python_costs.py [OTHER_FOLDER]    with another build's module: both in turns, and their ratio
"""
import subprocess
import sys
import time

REPEATS = 3
BOX = (-1.3, -1.3, -1.3, 1.3, 1.3, 1.3)
KINDS = {
    "formula": "x^2+y^2+z^2-1",
    "values": lambda x: (x * x).sum(1) - 1,
    "values and gradients": lambda x: ((x * x).sum(1) - 1, 2 * x),
    "values, gradients and Hessians": lambda x: ((x * x).sum(1) - 1, 2 * x, np.broadcast_to(2 * np.eye(3), (len(x), 3, 3))),
    "values, point by point": lambda x: x[0] * x[0] + x[1] * x[1] + x[2] * x[2] - 1,
}


def measure(kind, h):
    """Prints tets, CPU seconds, those in psi and its calls, of a mesh."""
    psi, inside, calls = KINDS[kind], 0., 0

    def counted(x):
        nonlocal inside, calls
        begin = time.process_time()
        answer = psi(x)
        inside += time.process_time() - begin
        calls += 1
        return answer

    umtet.mesh(KINDS["formula"], box=BOX, h=.5)  # loads what is loaded once
    begin = time.process_time()
    mesh = umtet.mesh(psi, box=BOX, h=h, threads=1)
    seconds = time.process_time() - begin
    if not isinstance(psi, str):
        umtet.mesh(counted, box=BOX, h=h, threads=1)
    print(len(mesh.tets), seconds, inside, calls)


def measured(folder, kind, h):
    """In a process of its own, with the module of that folder."""
    command = [sys.executable, __file__, "--measure", folder, kind, str(h)]
    words = subprocess.run(command, check=True, capture_output=True, text=True).stdout.split()
    return int(words[0]), *map(float, words[1:])


def main():
    folders = [umtet.__path__[0].rsplit("/", 1)[0], *sys.argv[1:]]
    for h in (.1, .05):
        for kind in KINDS:
            runs = [[measured(folder, kind, h) for folder in folders] for _ in range(REPEATS)]
            least = [min((run[k] for run in runs), key=lambda r: r[1]) for k in range(len(folders))]
            line = "; ".join(f"{r[1]:.2f} s, and {r[2]:.2f} s in psi, {r[3]:.0f} calls" for r in least)
            ratio = f"; ratio {least[1][1] / least[0][1]:.1f}" if len(folders) > 1 else ""
            print(f"h = {h}, {least[0][0]} tets, {kind}: {line}{ratio}", flush=True)


if __name__ == "__main__":
    if "--measure" in sys.argv:
        sys.path.insert(0, sys.argv[2])
    import numpy as np
    import umtet
    measure(sys.argv[3], float(sys.argv[4])) if "--measure" in sys.argv else main()
