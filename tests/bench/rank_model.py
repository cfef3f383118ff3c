#!/usr/bin/python3
"""rank_model.py measure FILE UMTET_MPI RANK_TRAFFIC [MPIEXEC]: what ranks take and send, by phase, into FILE (JSON).
rank_model.py fit FILE: each term of the model, fitted to that.
rank_model.py predict FILE [LATENCY]: what 64 and 4096 ranks would take for 10 G tets, of a formula and of a scan of 1 G points.

RANK_TRAFFIC is the library of rank_traffic.c. Some minutes of two cores; CPU seconds do not contain waiting. Needs
Debian's python3-numpy, and its python3-mpi4py for the latency.
"""
import json
import math
import os
import pathlib
import subprocess
import sys
import tempfile

import numpy as np

HERE = pathlib.Path(__file__).resolve().parent
RANKS = (1, 2, 3, 4)
TORUS = ["--implicit", "(sqrt(x^2+y^2)-1)^2+z^2-.16", "--box=-1.6,-1.6,-.6,1.6,1.6,.6"]
EDGES = (.0385, .0243, .0179)  # .5, 2 and 5 million tets
HELD_OUT = (.0141, 4)  # 10 million by 4 ranks: not fitted, but compared with what the model says
SCANS = ((150_000, .034), (500_000, .0187))  # samples and h, so that there are SAMPLES_A_FACE
COLUMNS = ("cpu", "cpu_in_mpi", "collectives", "exchanges", "messages", "sent", "gets", "got", "written", "peak")
# Of the whole run, in their order.
PHASES = ("start", "bands", "share_psi", "alone_psi", "partition", "signs", "classify", "project", "repair", "emit", "embed", "certify",
          "boundary", "alone_measures", "files", "alone_files")
ALONE = ("start", "alone_psi", "repair", "boundary", "alone_measures", "alone_files")  # of rank 0; others wait
BLOCK_TETS = 4**3 * 46  # distributed/partition/block_curve.h
ON_GRID = "components of psi = 0 and its size"
GRID_TETS = 5e7 / .435  # that grid has 5e7 nodes at most (kMaxGridNodes), and .435 for each tet of this torus
SAMPLES_A_FACE = 3.9  # dense_cloud.py 2000000, run with --h .03: 192,530 samples, 49,968 faces
READ_SECONDS, READ_BYTES = .6e-6, 64  # of a point that is merged (docs/performance.md, "Reconstruction")
ITERATIONS, LEVELS = 10, 12  # of a fit; each level has half the spacing of the one before
NEIGHBOURS = 26  # ranks next to one
PIECE = 1 << 16  # tets, distributed/certify/part_tets.cpp and io/part_files.cpp


def traffic(mpiexec, program, library, n, arguments, folder):
    """By rank and phase, the columns of rank_traffic.c; and the certificate."""
    case = folder / "case"
    subprocess.run(["rm", "-rf", str(case)], check=True)
    hook = ["-x", f"LD_PRELOAD={library}", "-x", f"UMTET_TRAFFIC={folder / 'traffic'}"]
    made = subprocess.run([mpiexec, "-n", str(n), "--oversubscribe", *hook, program, *arguments, "-o", str(case), "--no-report",
                           "--threads", "1", "--progress", "none", "--max-tets", "100000000"], capture_output=True, text=True)
    if made.returncode not in (0, 6):
        sys.exit(made.stderr)
    ranks = []
    for rank in range(n):
        rows = (line.split() for line in (folder / f"traffic.{rank}").read_text().splitlines())
        ranks.append({row[0]: dict(zip(COLUMNS, map(float, row[1:]))) for row in rows})
    return ranks, json.loads((case / "certificate.json").read_text())


def latency(mpiexec):
    """Seconds of an MPI_Allreduce of eight bytes by two ranks of this machine."""
    script = ("from mpi4py import MPI\nimport array, time\nc = MPI.COMM_WORLD\na, b = array.array('d', [1]), array.array('d', [0])\n"
              "best = 1e9\nfor _ in range(20):\n    c.Barrier()\n    t = time.perf_counter()\n    for _ in range(1000): c.Allreduce(a, b)\n"
              "    best = min(best, (time.perf_counter() - t) / 1000)\nif c.rank == 0: print(best)\n")
    made = subprocess.run([mpiexec, "-n", "2", "--oversubscribe", "/usr/bin/python3", "-c", script], capture_output=True, text=True)
    return float(made.stdout) if made.returncode == 0 else None


def measure(out, program, library, mpiexec="mpirun"):
    runs = []
    with tempfile.TemporaryDirectory() as name:
        folder = pathlib.Path(name)
        for h, n in [*((h, n) for h in EDGES for n in RANKS), HELD_OUT]:
            ranks, mesh = traffic(mpiexec, program, library, n, ["mesh", *TORUS, "--h", str(h)], folder)
            runs.append({"of": "formula" if h in EDGES else "held out", "n": n, "tets": mesh["n_tets"],
                         "faces": mesh["boundary"]["n_faces"], "samples": 0, "ranks": ranks})
            print(f"{n} ranks, {mesh['n_tets']} tets", flush=True)
        for samples, h in SCANS:
            subprocess.run([str(HERE / "dense_cloud.py"), str(samples)], check=True, cwd=folder)
            cloud = str(folder / f"dense_{samples}.ply")
            for n in RANKS:
                ranks, mesh = traffic(mpiexec, program, library, n,
                                      ["run", cloud, "--set", "cloud.merge=false", "--h", str(h), "--background", "a15"], folder)
                runs.append({"of": "scan", "n": n, "tets": mesh["n_tets"], "faces": mesh["boundary"]["n_faces"], "samples": samples, "ranks": ranks})
                print(f"{n} ranks, {samples} samples, {mesh['n_tets']} tets", flush=True)
    pathlib.Path(out).write_text(json.dumps({"runs": runs, "latency": latency(mpiexec)}, indent=1))


def neighbouring(tets, n):
    """Tets in blocks next to those of a rank, of all ranks, if the blocks of a rank are a cube."""
    side = (tets / n / BLOCK_TETS) ** (1 / 3)
    return 0 if n == 1 else n * BLOCK_TETS * ((side + 2) ** 3 - side**3)


def fitted(rows, values):
    """The factors >= 0 of the columns of `rows` with the least sum of squares of relative errors, and the worst of these."""
    A, y = np.array(rows, float), np.array(values, float)
    weight = 1 / np.maximum(y, 1e-3 * y.max())
    best = None
    for mask in range(1, 1 << A.shape[1]):
        columns = [k for k in range(A.shape[1]) if mask >> k & 1]
        x = np.zeros(A.shape[1])
        x[columns] = np.linalg.lstsq(A[:, columns] * weight[:, None], y * weight, rcond=None)[0]
        error = np.abs((A @ x - y) * weight)
        if (x >= 0).all() and (best is None or (error**2).sum() < best[0] - 1e-12):
            best = ((error**2).sum(), x, error.max())
    return best[1], best[2]


def columns_of(tets, faces, samples, n):
    beside = neighbouring(tets, n)
    return {"1": 1, "tet": tets, "face": faces, "neighbouring tet": beside, "sample": samples, "tet of a rank": tets / n,
            "neighbouring tet of a rank": beside / n, "sample of a rank": samples / n}


def fit_terms(runs, value, names):
    x, worst = fitted([[columns_of(r["tets"], r["faces"], r["samples"], r["n"])[name] for name in names] for r in runs],
                      [value(r) for r in runs])
    return {name: factor for name, factor in zip(names, x) if factor > 0}, worst


def together(phases):
    return lambda run: sum(rank.get(p, {}).get("cpu", 0) for p in phases for rank in run["ranks"])


def of_first(phases, column="cpu"):
    return lambda run: sum(run["ranks"][0].get(p, {}).get(column, 0) for p in phases)


def most(column, phases):
    return lambda run: max(sum(rank.get(p, {}).get(column, 0) for p in phases) for rank in run["ranks"])


def peak(first):
    ranks = (lambda run: run["ranks"][:1]) if first else (lambda run: run["ranks"][1:])
    return lambda run: max(max(row["peak"] for row in rank.values()) for rank in ranks(run))


OF_FIRST = (ON_GRID, "repair", "boundary", "rest of the certificate", "checksums of files")
IN_MESH, IN_PIECES = ("partition", "signs", "classify", "project", "emit", "embed"), ("certify", "files")


def model(file):
    data = json.loads(pathlib.Path(file).read_text())
    formula, scan = ([r for r in data["runs"] if r["of"] == kind] for kind in ("formula", "scan"))
    terms = {}  # name: (who, terms, worst relative error)

    def add(name, who, runs, value, names):
        terms[name] = (who, *fit_terms(runs, value, names))

    of_tets = ["tet", "face", "neighbouring tet"]
    add("mesh", "s of all ranks", formula, together(IN_MESH), of_tets)
    add("certificate", "s of all ranks", formula, together(["certify"]), of_tets)
    add("files", "s of all ranks", formula, together(["files"]), of_tets)
    add("bands of a fit", "s of all ranks", [r for r in scan if r["n"] > 1], together(["bands"]), ["sample"])
    add(ON_GRID, "s of rank 0", formula, of_first(["start", "alone_psi"]), ["1", "tet"])
    add("repair", "s of rank 0", formula, of_first(["repair"]), ["1", "face", "tet of a rank"])
    add("boundary", "s of rank 0", formula, of_first(["boundary"]), ["face"])
    add("rest of the certificate", "s of rank 0", formula, of_first(["alone_measures"]), ["1", "face"])
    add("checksums of files", "s of rank 0", formula, of_first(["alone_files"]), ["1", "tet"])
    # One rank makes its bands there, too.
    add("scan: cloud, coarsest lattice", "s of rank 0", [r for r in scan if r["n"] > 1], of_first(["start"]), ["1", "sample"])
    add("scan: sizes and components of psi = 0", "s of rank 0", [r for r in scan if r["n"] > 1], of_first(["alone_psi"]), ["1", "sample"])
    add("scan: rest of the certificate", "s of rank 0", scan, of_first(["alone_measures"]), ["1", "face"])
    add("sent for certificate and files", "bytes of all ranks", [r for r in formula if r["n"] > 1],
        lambda r: sum(rank[p]["sent"] for p in IN_PIECES for rank in r["ranks"]) * r["n"] / (r["n"] - 1), ["tet"])
    add("written", "bytes of all ranks", formula, lambda r: sum(rank["files"]["written"] for rank in r["ranks"]), ["tet", "face"])
    of_part = ["1", "tet of a rank", "neighbouring tet of a rank"]
    add("peak memory, formula", "bytes of rank 0", formula, peak(True), of_part + ["face"])
    add("peak memory, formula, others", "bytes of a rank", [r for r in formula if r["n"] > 1], peak(False), of_part)
    add("peak memory, scan", "bytes of rank 0", scan, peak(True), ["1", "sample", "sample of a rank", "tet of a rank"])
    add("peak memory, scan, others", "bytes of a rank", [r for r in scan if r["n"] > 1], peak(False), ["1", "sample", "sample of a rank", "tet of a rank"])
    several = [r for r in formula if r["n"] > 1]
    counts = {"exchanges": max(most("exchanges", IN_MESH)(r) for r in formula),
              "collectives": max(most("collectives", PHASES)(r) - rounds(r["tets"], r["n"]) * per_round(formula) for r in formula),
              "collectives a round": per_round(formula),
              "bytes of exchanges / sqrt(faces of a rank)": max(most("sent", IN_MESH)(r) / math.sqrt(r["faces"] / r["n"]) for r in several),
              "largest / mean CPU s of ranks": max(most("cpu", IN_MESH + IN_PIECES)(r) * r["n"] / together(IN_MESH + IN_PIECES)(r)
                                                 for r in several),
              "faces / tets^(2/3)": max(r["faces"] / r["tets"] ** (2 / 3) for r in formula),
              "s for an Allreduce of two ranks": data["latency"]}
    return terms, counts


def rounds(tets, n):
    """Pieces of consecutive tets that each rank has in turn."""
    return math.ceil(tets / PIECE / n)


def per_round(runs):
    """Collectives of certificate and files in each of these."""
    x, _ = fitted([[1, rounds(r["tets"], r["n"])] for r in runs], [most("collectives", IN_PIECES)(r) for r in runs])
    return x[1]


def value_of(terms, name, tets, faces, samples, n):
    of = columns_of(min(tets, GRID_TETS) if name == ON_GRID else tets, faces, samples, n)
    return sum(factor * of[unit] for unit, factor in terms[name][1].items())


def show_held_out(file, terms):
    for run in json.loads(pathlib.Path(file).read_text())["runs"]:
        if run["of"] != "held out":
            continue
        at = run["tets"], run["faces"], 0, run["n"]
        said = lambda names: sum(value_of(terms, name, *at) for name in names)
        rows = {"mesh, certificate and files, s of all ranks": (said(["mesh", "certificate", "files"]), together(IN_MESH + IN_PIECES)(run)),
                "rank 0 alone, s": (said(OF_FIRST), of_first(ALONE)(run)),
                "peak memory of rank 0, MB": (said(["peak memory, formula"]) / 1e6, peak(True)(run) / 1e6),
                "peak memory of others, MB": (said(["peak memory, formula, others"]) / 1e6, peak(False)(run) / 1e6)}
        print(f"\n| {run['tets']} tets by {run['n']} ranks | model | measured |\n|---|---|---|")
        for name, (model_says, measured) in rows.items():
            print(f"| {name} | {two_digits(model_says)} | {two_digits(measured)} |")


def two_digits(x):
    x = float(f"{x:.2g}")
    return f"{x:.0f}" if x >= 10 else f"{x:g}"


def readable(factor, unit, is_time):
    if is_time:
        x, of = (factor, "s") if unit == "1" else (1e6 * factor, f"µs per {unit}") if factor >= 1e-6 else (1e9 * factor, f"ns per {unit}")
        return f"{two_digits(x)} {of}"
    return f"{factor / 1e6:.0f} MB" if unit == "1" else f"{factor:.0f} B per {unit}"


def show_fit(file):
    terms, counts = model(file)
    print("| term | ranks | fitted | worst error |\n|---|---|---|---|")
    for name, (who, factors, worst) in terms.items():
        unit, _, of = who.partition(" of ")
        print(f"| {name} | {of} | {' + '.join(readable(x, per, unit == 's') for per, x in factors.items())} | {worst:.0%} |")
    print("\n| count | |\n|---|---|")
    for name, x in counts.items():
        print(f"| {name} | {x:.2g} |" if x < 10 else f"| {name} | {two_digits(x)} |")
    show_held_out(file, terms)


def predict(file, latency=None, tets=10e9, points=1e9):
    terms, counts = model(file)
    faces = counts["faces / tets^(2/3)"] * tets ** (2 / 3)
    samples = min(points, SAMPLES_A_FACE * faces)
    latency = float(latency or counts["s for an Allreduce of two ranks"])
    spread = counts["largest / mean CPU s of ranks"]

    def value(name, n):
        return value_of(terms, name, tets, faces, samples, n)

    def row(name, f):
        print(f"| {name} | " + " | ".join(two_digits(f(n)) for n in (64, 4096)) + " |")

    def each(name):
        row(f"{name}, each rank, s", lambda n: spread * value(name, n) / n)

    def alone(name, title=None):
        row(f"{title or name}, rank 0 alone, s", lambda n: value(name, n))

    print(f"{tets:.2g} tets, {faces:.2g} boundary faces; {samples:.2g} samples of {points:.2g} points; {1e6 * latency:.2g} µs a message\n")
    print("| formula | 64 ranks | 4096 ranks |\n|---|---|---|")
    for name in ("mesh", "certificate", "files"):
        each(name)
    row("exchanges with neighbours, s", lambda n: counts["exchanges"] * NEIGHBOURS * latency)
    row("collectives, s", lambda n: counts["collectives"] * math.log2(n) * latency)
    row("all to all, for certificate and files, s", lambda n: counts["collectives a round"] * rounds(tets, n) * n * latency)
    for name in OF_FIRST:
        alone(name)
    row("sent by each rank for certificate and files, GB", lambda n: value("sent for certificate and files", n) / n / 1e9)
    row("sent by each rank to neighbours, MB", lambda n: counts["bytes of exchanges / sqrt(faces of a rank)"] * math.sqrt(faces / n) / 1e6)
    row("written, TB", lambda n: value("written", n) / 1e12)
    row("peak memory of rank 0, GB", lambda n: value("peak memory, formula", n) / 1e9)
    row("peak memory of others, GB", lambda n: value("peak memory, formula, others", n) / 1e9)
    print("\n| scan, in addition | 64 ranks | 4096 ranks |\n|---|---|---|")
    row("reads and merges points, rank 0 alone, s", lambda n: points * READ_SECONDS)
    alone("scan: cloud, coarsest lattice", "cloud, coarsest lattice")
    each("bands of a fit")
    row("sums of conjugate gradients from rank to rank, s", lambda n: 2 * n * ITERATIONS * LEVELS * latency)
    alone("scan: sizes and components of psi = 0", "sizes and components of psi = 0")
    alone("scan: rest of the certificate", "rest of the certificate")
    row("peak memory of rank 0, GB", lambda n: max(value("peak memory, scan", n), points * READ_BYTES) / 1e9)
    row("peak memory of others, GB", lambda n: value("peak memory, scan, others", n) / 1e9)


def allow_root():
    """Open MPI asks for it, in a container."""
    os.environ.setdefault("OMPI_ALLOW_RUN_AS_ROOT", "1")
    os.environ.setdefault("OMPI_ALLOW_RUN_AS_ROOT_CONFIRM", "1")


if __name__ == "__main__":
    allow_root()
    {"measure": measure, "fit": show_fit, "predict": predict}[sys.argv[1]](*sys.argv[2:])
