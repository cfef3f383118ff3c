#!/usr/bin/python3
"""Meshes of several regions by umtet, CGAL and Gmsh: beside_others.py UMTET [--cgal=PROGRAM] [--tets=N] [NAME ...]

PROGRAM is that of cgal_regions.cpp. Gmsh (Debian's package) meshes OpenCASCADE's fragments of the same bodies by HXT and
optimises them. umtet makes about N tets; the others get the edge length at which they make about as many. All meshes are
judged by `umtet check`. Images of labels are those of label_volumes.py, without Gmsh.
"""
import json
import pathlib
import resource
import subprocess
import sys
import tempfile

from label_volumes import VOLUMES, write

SECONDS = 900
BALL = "x^2+y^2+z^2-1"
# Name: arguments of umtet, half of the cube, name in cgal_regions.cpp, script of Gmsh.
DOMAINS = {
    "sphere": ([f"ball={BALL}"], 1.4, "sphere", "Sphere(2) = {0,0,0, 1};"),
    "torus": (["ring=(x^2+y^2+z^2+1-.16)^2-4*(x^2+y^2)"], 1.8, "torus", "Torus(2) = {0,0,0, 1, .4};"),
    "nested spheres": ([f"shell={BALL}", "core=x^2+y^2+z^2-.36"], 1.4, "nested",
                       "Sphere(2) = {0,0,0, 1}; Sphere(3) = {0,0,0, .6};"),
    "double bubble": (["--least", "a=(x-.5)^2+y^2+z^2-1", "b=(x+.5)^2+y^2+z^2-1"], 1.9, "bubble",
                      "Sphere(2) = {.5,0,0, 1}; Sphere(3) = {-.5,0,0, 1}; Box(4) = {0,-2,-2, 2,4,4};"
                      "Box(5) = {-2,-2,-2, 2,4,4};"
                      "BooleanIntersection(6) = {Volume{2}; Delete;}{Volume{4}; Delete;};"
                      "BooleanIntersection(7) = {Volume{3}; Delete;}{Volume{5}; Delete;};"),
    "ball cut in two": (["--least", f"a={BALL}+.02*x", f"b={BALL}-.02*x"], 1.4, "cut",
                        "Sphere(2) = {0,0,0, 1, -Pi/2, Pi/2, Pi}; Sphere(3) = {0,0,0, 1, -Pi/2, Pi/2, Pi};"
                        "Rotate{{0,0,1}, {0,0,0}, Pi}{Volume{3};}"),
}
IMAGES = ("head", "knee")


def timed(words):
    before = resource.getrusage(resource.RUSAGE_CHILDREN)
    try:
        done = subprocess.run([str(w) for w in words], capture_output=True, text=True, timeout=SECONDS, check=False)
    except subprocess.TimeoutExpired:
        return None, SECONDS
    after = resource.getrusage(resource.RUSAGE_CHILDREN)
    return done, after.ru_utime + after.ru_stime - before.ru_utime - before.ru_stime


def row(umtet, name, tool, file, seconds):
    """Prints what `umtet check` finds, and returns the number of tets."""
    done, _ = timed([umtet, "check", "--json", file])
    try:
        found = json.loads(done.stdout)["check"]
    except (AttributeError, ValueError, KeyError):
        print(f"| {name} | {tool} | no mesh | | | | | |", flush=True)
        return 0
    q, volumes = found["quality"], {r["name"]: r["volume"] for r in found["regions"] or []}
    print(f"| {name} | {tool} | {found['n_tets']:,} | {q['min']:.3f} | {q['p01']:.3f} | {q['dihedral_min_deg']:.0f} to "
          f"{q['dihedral_max_deg']:.0f}° | {', '.join(f'{v:.4g}' for v in sorted(volumes.values(), reverse=True))} | "
          f"{seconds:.1f} |", flush=True)
    return found["n_tets"]


def inr_of(label, path):
    n = label.shape
    head = f"#INRIMAGE-4#{{\nXDIM={n[0]}\nYDIM={n[1]}\nZDIM={n[2]}\nVDIM=1\nTYPE=unsigned fixed\nPIXSIZE=8 bits\nCPU=decm\nVX=1\nVY=1\nVZ=1\n"
    path.write_bytes((head + "\n" * (252 - len(head)) + "##}\n").encode() + label.tobytes(order="F"))


def of_gmsh(script, half, edge, folder):
    geo = folder / "regions.geo"
    geo.write_text(f"SetFactory('OpenCASCADE'); Box(1) = {{{-half},{-half},{-half}, {2 * half},{2 * half},{2 * half}}};\n"
                   f"{script}\no() = Volume{{:}}; o() -= {{1}}; f() = BooleanFragments{{Volume{{1}}; Delete;}}{{Volume{{o()}}; Delete;}};\n"
                   "For k In {0:#f()-1}\n  Physical Volume(k + 1) = {f(k)};\nEndFor\n"
                   f"Mesh.CharacteristicLengthMin = {edge}; Mesh.CharacteristicLengthMax = {edge};\n")
    return timed(["gmsh", geo, "-3", "-algo", "hxt", "-optimize", "-optimize_threshold", "0.5", "-nt", "1", "-format",
                  "msh41", "-o", folder / "gmsh.msh", "-v", "1"])


def main():
    umtet = sys.argv[1]
    options = dict(a[2:].split("=") for a in sys.argv[2:] if a.startswith("--"))
    names = [a for a in sys.argv[2:] if not a.startswith("--")] or [*DOMAINS, *IMAGES]
    cgal, n_tets = options.get("cgal"), int(options.get("tets", 200000))
    print("| domain | program | tets | least Q | 1 % Q | dihedral angles | volumes | CPU s |\n|---|---|---|---|---|---|---|---|")
    with tempfile.TemporaryDirectory() as temporary:
        folder = pathlib.Path(temporary)
        for name in names:
            if name in DOMAINS:
                words, half, of_cgal, script = DOMAINS[name]
                words = [*words, f"--box={','.join([str(-half)] * 3 + [str(half)] * 3)}", "--tets", n_tets]
            else:
                label, _ = VOLUMES[name](96)
                write(folder / "image.nrrd", label)
                inr_of(label, folder / "image.inr")
                words, half, of_cgal, script = [folder / "image.nrrd", "--no-outside", "--tets", n_tets], 0, folder / "image.inr", None
            _, seconds = timed([umtet, "regions", *words, "-o", folder / "umtet", "--threads", "1", "-q"])
            wanted = row(umtet, name, "umtet", folder / "umtet/regions.vtu", seconds)
            edge = json.loads((folder / "umtet/regions.json").read_text())["h"]
            programs = {"Gmsh HXT": lambda e: (of_gmsh(script, half, e, folder), folder / "gmsh.msh")} if script else {}
            if cgal:
                programs["CGAL"] = lambda e: (timed([cgal, of_cgal, half, e, folder / "cgal.mesh"]), folder / "cgal.mesh")
            for tool, run in programs.items():
                (_, seconds), file = run(edge)
                done, _ = timed([umtet, "check", "--json", file])
                n = json.loads(done.stdout)["check"]["n_tets"] if done and done.stdout else 0
                if n and not .8 < n / wanted < 1.25:  # once more, with the size that this program needs
                    (_, seconds), file = run(edge * (n / wanted)**(1 / 3))
                row(umtet, name, tool, file, seconds)
                file.unlink(missing_ok=True)


if __name__ == "__main__":
    main()
