#!/usr/bin/python3
"""umtet beside TetGen, Gmsh and CGAL on the same shapes and sizes: OUT/summary.md, table.md, table.csv,
rows.json.

usage: tests/bench/peers/compare.py [-o OUT] [--shapes sphere,torus] [--sizes 100000] [--tools umtet-fast,tetgen] [--repeat 3]
       --quick is the sphere at 20,000 tets, once; --resume keeps the rows that OUT has (a whole run takes half an hour)

Needs Debian's tetgen, gmsh, libcgal-dev, python3-meshio, python3-scipy; a tool that is missing is a row that says so.
Every mesh is made by one process on one thread. CPU is user + system of that process, files read and written included,
the median of --repeat runs where one takes less than four seconds; MB is the most it held. All other numbers are measure.py's, from the file it wrote.
The surface meshers (TetGen, Gmsh) get the boundary of umtet's mesh, its vertices on psi = 0, as in Section 3.5 of the
paper; making it is not counted. Sizes: TetGen's greatest volume is twice umtet's mean one, HXT takes the skin's and
makes fewer tets, so it gets the skin of a finer mesh, CGAL gets umtet's edge length.
"""
import argparse
import csv
import json
import os
import shutil
import statistics
import subprocess
import sys
from pathlib import Path

HERE = Path(__file__).resolve().parent
ROOT = HERE.parents[2]
SHAPES = ["sphere", "torus", "equation_9", "banchoff_chmutov_6", "equation_13"]
TOOLS = {
    "umtet-fast": "umtet --mode fast",
    "umtet-paper": "umtet --mode paper",
    "tetgen": "TetGen -pYq1.2/14O9/7o/130a",
    "gmsh-hxt": "Gmsh HXT",
    "gmsh-hxt-opt": "Gmsh HXT, OptimizeThreshold .5",
    "cgal": "CGAL Mesh_3, no optimisation",
    "cgal-opt": "CGAL Mesh_3, odt + perturb + exude",
}
COLUMNS = ["tool", "shape", "tets", "pieces", "inverted", "min_Q", "p01_Q", "mean_Q", "dihedral_min", "dihedral_max",
           "vertex_distance", "centroid_distance", "ktets_per_CPU_s", "peak_MB"]


def timed(command, folder):
    """CPU seconds, peak MB and standard output of a process. This script stays small: a child's peak begins at its size."""
    with open(folder / "stdout", "w+") as out, open(folder / "stderr", "w") as err:
        process = subprocess.Popen([str(c) for c in command], cwd=folder, stdout=out, stderr=err)
        _, status, usage = os.wait4(process.pid, 0)
        process.returncode = os.waitstatus_to_exitcode(status)
        if process.returncode != 0:
            raise RuntimeError(f"{command[0]} ended with {process.returncode}, see {folder}/stderr")
        out.seek(0)
        return usage.ru_utime + usage.ru_stime, usage.ru_maxrss / 1024, out.read()


def gmsh_input(folder, pieces, threshold):
    lines = ['Merge "finer.msh";', "Mesh.Algorithm3D = 10;"] + [
        f"Surface Loop({k}) = {{{k}}}; Volume({k}) = {{{k}}};" for k in range(1, pieces + 1)]
    if threshold:
        lines.append(f"Mesh.OptimizeThreshold = {threshold};")
    (folder / "in.geo").write_text("\n".join(lines) + "\n")


HXT_FINER = 1.75  # tets of the mesh whose skin HXT gets, over those asked for: about as many come out
REPEAT_BELOW = 4  # CPU seconds


def job(tool, programs, shape, size, ours, folder):
    """The command that makes a mesh, and its file; None where the tool is not installed."""
    if tool.startswith("umtet"):
        return [programs / "peer_umtet", shape, size, tool[6:], "mesh.msh"], "mesh.msh"
    if tool.startswith("cgal"):
        program = programs / "peer_cgal"
        how = "optimised" if tool == "cgal-opt" else "plain"
        return ([program, shape, ours["h"], how, "mesh.mesh"], "mesh.mesh") if program.exists() else None
    if not shutil.which(tool.split("-")[0]):
        return None
    if tool == "tetgen":
        volume = f"{2 * ours['volume'] / ours['tets']:.6g}"
        return ["tetgen", f"-pYq1.2/14O9/7o/130a{volume}FQ", "skin.off"], "skin.1.ele"
    gmsh_input(folder, ours["pieces"], ".5" if tool == "gmsh-hxt-opt" else None)
    return ["gmsh", "-3", "in.geo", "-format", "msh41", "-bin", "-nt", "1", "-v", "1", "-o", "mesh.msh"], "mesh.msh"


def row(tool, programs, shape, size, ours, folder, repeat):
    made = job(tool, programs, shape, size, ours, folder)
    if made is None:
        return {"note": "not installed"}
    command, mesh = made
    try:
        runs = [timed(command, folder)]
        while len(runs) < repeat and runs[0][0] < REPEAT_BELOW:
            runs.append(timed(command, folder))
    except RuntimeError as failure:
        return {"note": str(failure)}
    measure = [HERE / "measure.py", folder / mesh, shape, "--h", str(ours["h"])]
    result = json.loads(subprocess.run(measure, check=True, capture_output=True, text=True).stdout)
    result["CPU_s"] = statistics.median(r[0] for r in runs)
    result["ktets_per_CPU_s"] = result["tets"] / result["CPU_s"] / 1000
    result["peak_MB"] = max(r[1] for r in runs)
    if tool.startswith("umtet"):
        stages = [json.loads(r[2]) for r in runs]
        result["umtet"] = dict(stages[0], **{k: statistics.median(s[k] for s in stages)
                                             for k in ("mesh_s", "certificate_s", "write_s")})
        if stages[0]["failures"]:
            result["note"] = "; ".join(stages[0]["failures"])
    return result


def cell(name, value):
    if value is None or isinstance(value, str):
        return value or ""
    if name.endswith("_Q"):
        return f"{value:.3f}"
    if name.startswith("dihedral"):
        return f"{value:.1f}"
    return f"{value:.1e}" if name.endswith("distance") else f"{value:.0f}"


def write_table(rows, out):
    with open(out / "table.csv", "w", newline="") as file:
        writer = csv.DictWriter(file, COLUMNS + ["size", "CPU_s", "note"], extrasaction="ignore")
        writer.writeheader()
        writer.writerows(rows)
    with open(out / "table.md", "w") as file:
        for size in dict.fromkeys(r["size"] for r in rows):
            file.write(f"\n{size} tets asked for. Distances: the greatest, in edge lengths, from vertices and centroids of "
                       "the boundary to psi = 0.\n\n| " + " | ".join(COLUMNS) + " |\n" + "|---" * len(COLUMNS) + "|\n")
            for r in (r for r in rows if r["size"] == size):
                cells = [r["tool"], r["shape"]] + [cell(c, r.get(c)) for c in COLUMNS[2:]]
                if "tets" not in r:
                    cells[2] = r["note"]
                file.write("| " + " | ".join(cells) + " |\n")


def write_summary(rows, out):
    """One line per size and tool over the shapes: the worst of what is extreme, the median of the rest."""
    with open(out / "summary.md", "w") as file:
        file.write("| tets | tool | shapes | min Q | 1 % Q | mean Q | dihedral angles | vertices off psi = 0 | centroids | "
                   "ktets / CPU s | MB / 100k tets |\n" + "|---" * 11 + "|\n")
        for size, tool in dict.fromkeys((r["size"], r["tool"]) for r in rows):
            of = [r for r in rows if (r["size"], r["tool"]) == (size, tool) and "tets" in r]
            if not of:
                file.write(f"| {size} | {tool} | 0: not installed, or failed |" + " |" * 8 + "\n")
                continue
            column = {c: [r[c] for r in of] for c in COLUMNS[2:]}
            middle = {c: statistics.median(v) for c, v in column.items()}
            MB = statistics.median(1e5 * r["peak_MB"] / r["tets"] for r in of)
            file.write(f"| {size} | {tool} | {len(of)} | {min(column['min_Q']):.3f} | {middle['p01_Q']:.3f} | "
                       f"{middle['mean_Q']:.3f} | {min(column['dihedral_min']):.1f} to {max(column['dihedral_max']):.1f} | "
                       f"{max(column['vertex_distance']):.0e} | {max(column['centroid_distance']):.2f} | "
                       f"{middle['ktets_per_CPU_s']:.0f} | {MB:.0f} |\n")


def compare(tools, programs, shape, size, folder, repeat):
    """One row per tool."""
    folder.mkdir(parents=True, exist_ok=True)
    ours = json.loads(timed([programs / "peer_umtet", shape, size, "fast", "ours.msh", "skin"], folder)[2])
    timed([programs / "peer_umtet", shape, HXT_FINER * float(size), "fast", "ours.msh", "finer"], folder)
    rows = []
    for tool in tools:
        result = row(tool, programs, shape, size, ours, folder, repeat)
        rows.append({"tool": TOOLS[tool], "shape": shape, "size": size, **result})
        print(f"{size} {shape}, {TOOLS[tool]}: {result.get('note', '')}", *[
            f"{c} {cell(c, result.get(c))}" for c in COLUMNS[2:] if c in result], file=sys.stderr)
    return rows


def build():
    folder = ROOT / "build" / "release"
    for command in (["cmake", "--preset", "release", "-DUMTET_BUILD_PEERS=ON"], ["cmake", "--build", folder, "--target", "peers"]):
        subprocess.run(command, cwd=ROOT, check=True, stdout=sys.stderr)
    return folder / "tests" / "bench" / "peers"


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("-o", type=Path, default=ROOT / "build" / "peers")
    parser.add_argument("--shapes", default=",".join(SHAPES))
    parser.add_argument("--sizes", default="100000,500000")
    parser.add_argument("--tools", default=",".join(TOOLS))
    parser.add_argument("--repeat", type=int, default=3)
    parser.add_argument("--quick", action="store_true")
    parser.add_argument("--resume", action="store_true")
    parser.add_argument("--programs", type=Path, help="folder of peer_umtet and peer_cgal; built when not given")
    args = parser.parse_args()
    if args.quick:
        args.shapes, args.sizes, args.repeat = "sphere", "20000", 1
    programs = args.programs.resolve() if args.programs else build()
    rows, order = [], list(TOOLS.values())
    if args.resume and (args.o / "rows.json").exists():
        rows = [r for r in json.loads((args.o / "rows.json").read_text()) if "tets" in r]
    for size in args.sizes.split(","):
        for shape in args.shapes.split(","):
            done = {r["tool"] for r in rows if (r["shape"], r["size"]) == (shape, size)}
            tools = [t for t in args.tools.split(",") if TOOLS[t] not in done]
            if tools:
                rows += compare(tools, programs, shape, size, args.o.resolve() / f"{shape}-{size}", args.repeat)
                rows.sort(key=lambda r: (int(r["size"]), SHAPES.index(r["shape"]), order.index(r["tool"])))
                (args.o / "rows.json").write_text(json.dumps(rows))
                write_table(rows, args.o)
                write_summary(rows, args.o)
    print((args.o / "summary.md").read_text())


if __name__ == "__main__":
    main()
