#!/usr/bin/python3
"""Both sides of a surface, and curves where three regions meet: region_meshes.py UMTET [--positions=N] [--tets=N,N] [BODY ...]

Makes meshes of bodies by `umtet regions`, in N random positions each (rotations, and shifts by up to an edge), and prints
the worst least Q of each side, with the time of `umtet mesh` for the same body and h. The background ends in the box.
"""
import json
import math
import pathlib
import random
import resource
import subprocess
import sys
import tempfile

T6 = "+".join(f"(32*{v}^6-48*{v}^4+18*{v}^2-1)" for v in ("x", "y", "z"))
# Name: formulas of the bodies, half of the box. eq. (9) and T6 are those of the paper.
BODIES = {
    "sphere": (["x^2+y^2+z^2-1"], 1.4),
    "torus": (["(x^2+y^2+z^2+1-.16)^2-4*(x^2+y^2)"], 1.8),
    "T6, genus 28": ([T6], 2),
    "nested spheres": (["x^2+y^2+z^2-1", "x^2+y^2+z^2-.36"], 1.4),
    "two spheres that overlap": (["(x-.5)^2+y^2+z^2-.64", "(x+.5)^2+y^2+z^2-.64"], 1.8),
}
BALL = "x^2+y^2+z^2-1"
# Of these, a point belongs to the least; the angles are those between the sheets at their curves.
LEAST = {
    "ball cut in two, 90/90/180 degrees": ([f"{BALL}+.02*x", f"{BALL}-.02*x"], 1.4),
    "ball cut off its centre, 49/131/180 degrees": ([f"{BALL}+.02*(x-.65)", f"{BALL}-.02*(x-.65)"], 1.4),
    "double bubble, 120/120/120 degrees": (["(x-.5)^2+y^2+z^2-1", "(x+.5)^2+y^2+z^2-1"], 1.9),
    "ball in three, two corners": ([f"{BALL}+.3*x", f"{BALL}-.3*x+.25*y", f"{BALL}-.3*y"], 1.6),
    "ball in four, eight corners": ([f"{BALL}+.3*x", f"{BALL}-.3*x+.25*y", f"{BALL}-.3*y", f"{BALL}+.4*z-.2*x"], 1.6),
}


def rotation(generator):
    q = [generator.gauss(0, 1) for _ in range(4)]
    n = math.sqrt(sum(c * c for c in q))
    w, x, y, z = (c / n for c in q)
    return [[1 - 2 * (y * y + z * z), 2 * (x * y - w * z), 2 * (x * z + w * y)],
            [2 * (x * y + w * z), 1 - 2 * (x * x + z * z), 2 * (y * z - w * x)],
            [2 * (x * z - w * y), 2 * (y * z + w * x), 1 - 2 * (x * x + y * y)]]


def placed(formula, R, shift):
    """The formula in rotated and shifted coordinates."""
    names = dict(zip("xyz", (f"({R[r][0]:.17g}*(x-{shift[0]:.17g})+{R[r][1]:.17g}*(y-{shift[1]:.17g})"
                             f"+{R[r][2]:.17g}*(z-{shift[2]:.17g}))".replace("--", "+").replace("+-", "-") for r in range(3))))
    return "".join(names.get(c, c) for c in formula)


def cpu_of(words):
    before = resource.getrusage(resource.RUSAGE_CHILDREN)
    done = subprocess.run(words, capture_output=True, text=True, check=False)
    after = resource.getrusage(resource.RUSAGE_CHILDREN)
    return done, after.ru_utime + after.ru_stime - before.ru_utime - before.ru_stime


def main():
    umtet = sys.argv[1]
    options = dict(a[2:].split("=") for a in sys.argv[2:] if a.startswith("--"))
    chosen = [a for a in sys.argv[2:] if not a.startswith("--")]
    n_positions = int(options.get("positions", 3))
    sizes = [int(n) for n in options.get("tets", "100000").split(",")]
    print("| body | tets | positions that pass | least Q at the walls | outside | of bodies | 1 % Q | dihedral angles | CPU s | CPU s of one side |")
    print("|---|---|---|---|---|---|---|---|---|---|")
    with tempfile.TemporaryDirectory() as folder:
        out = pathlib.Path(folder)
        for name, (formulas, half) in (BODIES | LEAST).items():
            if chosen and name not in chosen:
                continue
            for n_tets in sizes:
                generator = random.Random(1)
                passed, walls, outside, inside, one, angles, cpu, alone = 0, [], [], [], [], [], [], []
                for _ in range(n_positions):
                    R = rotation(generator)
                    shift = [generator.uniform(-.02, .02) for _ in range(3)]
                    bodies = [placed(f, R, shift) for f in formulas]
                    box = f"--box={','.join([str(-half)] * 3 + [str(half)] * 3)}"
                    words = [umtet, "regions", *(f"b{k}={f}" for k, f in enumerate(bodies)), box, "--tets", str(n_tets),
                             "-o", str(out), "--threads", "1", "-q"]
                    if name in LEAST:
                        words.append("--least")
                    done, seconds = cpu_of(words)
                    if done.returncode not in (0, 6):
                        print(f"{name}: {done.stderr.strip()}", file=sys.stderr)
                        continue
                    found = json.loads((out / "regions.json").read_text())
                    passed += found["verdict"] == "pass"
                    cpu.append(seconds)
                    q = {r["name"]: r["quality"] for r in found["regions"]}
                    least = {r["name"]: r["min_quality_off_boundary"] for r in found["regions"]}
                    walls.append(q["outside"]["min"])
                    outside.append(least.pop("outside"))
                    inside.append(min(least.values()))
                    one.append(min(v["p01"] for k, v in q.items()))
                    angles.append((found["quality"]["dihedral_min_deg"], found["quality"]["dihedral_max_deg"]))
                    if len(bodies) == 1:
                        _, seconds = cpu_of([umtet, "mesh", "--implicit", bodies[0], box, "--h", str(found["h"]), "-o",
                                             str(out / "one"), "--threads", "1", "--no-report", "-q"])
                        alone.append(seconds)
                if not cpu:
                    continue
                print(f"| {name} | {found['n_tets']:,} | {passed} of {n_positions} | {min(walls):.3f} | {min(outside):.3f} | {min(inside):.3f} | {min(one):.3f} | "
                      f"{min(a for a, _ in angles):.0f} to {max(b for _, b in angles):.0f}° | {sorted(cpu)[len(cpu) // 2]:.1f} | "
                      f"{f'{sorted(alone)[len(alone) // 2]:.1f}' if alone else ''} |", flush=True)


if __name__ == "__main__":
    main()
