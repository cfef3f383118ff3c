#!/usr/bin/python3
"""Figures 8, 9/10, 14, 15, 18 to 21B and 24 to 26 of the paper by this project, as docs/figure_8.svg, figure_10.svg ...

usage: tools/docs/figures.py [--only 14,24] [--data build/figures] [--peers build/peers] [--programs FOLDER] [--umtet PROGRAM]
                       [--swimmer PROGRAM] [--most 8000000]

What is missing of the data is made: Figure 8 by `umtet run --mode paper`, 9/10 by tests/bench/peers/compare.py, 14 and 15
by `umtet mesh`, 19 by examples/swimmer/bird.py, 20 and 21B by `umtet evolve`, 24 to 26 by umtet_swimmer, 18 by peer_umtet
(both programs are built by compare.py --quick). Remove a folder to have its data made anew. Needs Debian's
python3-matplotlib and python3-vtk9; some fifteen minutes.
"""
import argparse
import csv
import io
import json
import re
import subprocess
from pathlib import Path

import matplotlib
matplotlib.use("svg")
import matplotlib.pyplot as plt  # noqa: E402
import numpy as np  # noqa: E402
from vtkmodules.vtkCommonDataModel import vtkPlane  # noqa: E402
from vtkmodules.vtkFiltersCore import vtkCutter  # noqa: E402
from vtkmodules.util.numpy_support import vtk_to_numpy  # noqa: E402

import drawn_figures  # noqa: E402
from mesh_svg import Mesh  # noqa: E402

ROOT = Path(__file__).resolve().parents[2]
GENUS = {"sphere": 0, "torus": 1, "plate_3": 3, "plate_18": 18, "banchoff_chmutov_8": 81}
plt.rcParams.update({"svg.fonttype": "none", "svg.hashsalt": "umtet", "font.size": 9, "axes.grid": True,
                     "grid.alpha": .3, "path.simplify_threshold": .6, "savefig.dpi": 150, "legend.frameon": False, "axes.spines.top": False, "axes.spines.right": False})


def save(figure, name):
    """Coordinates to a tenth of a point: half the bytes."""
    text = io.StringIO()
    figure.savefig(text, format="svg", metadata={"Date": None})
    lines = (line if "<text" in line else re.sub(r"(\d\.\d)\d+", r"\1", line) for line in text.getvalue().split("\n"))
    (ROOT / "docs" / name).write_text("\n".join(lines))


def figure_8(data, umtet):
    case = data / "duck"
    if not (case / "3-mesh" / "quality.csv").exists():
        subprocess.run([umtet, "run", ROOT / "data/clouds/duck.ply", "-o", case, "--mode", "paper", "--tets", "60000"],
                       check=True)
    with open(case / "3-mesh" / "quality.csv") as file:
        rows = list(csv.DictReader(file))
    figure, axes = plt.subplots(1, 2, figsize=(8, 3), sharey=True)
    curves = (("omega_h", "subset of the background", "tab:gray"), ("projected", "projected", "tab:blue"),
              ("final", "final", "tab:green"))
    for axis, prefix, title in ((axes[0], "", "all tets"), (axes[1], "boundary_", "tets with a positive vertex")):
        for name, label, colour in curves:
            points = [(int(r["index"]), float(r[prefix + name])) for r in rows if r[prefix + name]]
            axis.plot(*zip(*points), color=colour, label=label, lw=1.2)
        axis.set(xscale="log", title=title, xlabel="vertex, ascending in quality")
    axes[0].set_ylabel("least Q at the vertex")
    axes[0].legend()
    figure.tight_layout()
    save(figure, "figure_8.svg")


def figure_10(peers, programs):
    if not (peers / "rows.json").exists():
        more = ["--programs", programs] if programs else []
        subprocess.run([ROOT / "tests/bench/peers/compare.py", "-o", peers, *more], check=True)
    rows = [r for r in json.loads((peers / "rows.json").read_text()) if r["size"] == "100000" and "tets" in r]
    shapes, tools = (list(dict.fromkeys(r[k] for r in rows)) for k in ("shape", "tool"))
    colours = dict(zip(tools, ("tab:green", "tab:olive", "tab:red", "tab:orange", "tab:brown", "tab:blue", "tab:purple")))
    figure, axes = plt.subplots(2, len(shapes), figsize=(12, 5.4), sharey="row", squeeze=False)
    for r in rows:
        top, bottom = axes[:, shapes.index(r["shape"])]
        q, a = (np.array(r[k]).reshape(-1, n).sum(1) for k, n in (("Q_histogram", 2), ("angle_histogram", 3)))
        style = {"color": colours[r["tool"]], "label": r["tool"], "lw": 1.1}
        share = np.cumsum(q) / r["tets"]
        top.plot(np.arange(1, len(q) + 1)[share > 0] / len(q), share[share > 0], **style)
        bottom.plot(np.arange(.5, len(a))[a > 0] * 180 / len(a), (a / a.sum())[a > 0], **style)
        top.set(title=r["shape"], yscale="log", xlim=(0, 1), ylim=(1e-5, 1.2), xlabel="mean ratio Q")
        bottom.set(yscale="log", xlim=(0, 180), ylim=(1e-6, .3), xticks=range(0, 181, 45), xlabel="dihedral angle, degrees")
    axes[0, 0].set_ylabel("share of tets below Q")
    axes[1, 0].set_ylabel("share of angles, three degrees each")
    figure.legend(*axes[0, 0].get_legend_handles_labels(), loc="lower center", ncol=4)
    figure.tight_layout(rect=(0, .08, 1, 1))
    save(figure, "figure_10.svg")


def figure_15(data, umtet):
    by_paper = {"a15": .645, "z": .667, "slab": .600, "cube": .394}
    figure, axis = plt.subplots(figsize=(5.4, 3))
    for k, (mode, colour) in enumerate((("paper", "tab:blue"), ("fast", "tab:green"))):
        for place, background in enumerate(by_paper):
            case = data / "figure_15" / f"{background}_{mode}"
            if not (case / "certificate.json").exists():
                drawn_figures.run(umtet, "mesh", "--implicit", drawn_figures.EQUATION_9, "--box=-2.1,-2.1,-1.05,2.1,2.1,1.05", "--tets",
                                  "100000", "--background", background, "--mode", mode, "-o", case)
            q = json.loads((case / "certificate.json").read_text())["quality"]["min"]
            axis.bar(place + .27 * k, q, .25, color=colour, label=f"--mode {mode}" if place == 0 else None)
            axis.text(place + .27 * k, q, f"{q:.3f}", ha="center", va="bottom", fontsize=7)
    axis.bar(np.arange(4) - .27, by_paper.values(), .25, color="tab:gray", label="the paper")
    axis.set(xticks=range(4), xticklabels=by_paper, ylabel="least Q", ylim=(0, 1), title="eq. (9), 100k tets")
    axis.legend(ncol=3)
    figure.tight_layout()
    save(figure, "figure_15.svg")


def equation_13(data, umtet):
    """The folder of its meshes."""
    case = data / "figure_21"
    if not (case / "quality.csv").exists():
        subprocess.run([umtet, "evolve", "--implicit", drawn_figures.EQUATION_13, "--box=-2.1,-2.1,-2.1,2.1,2.1,2.1", "--h",
                        "0.0922", "--t", "0:0.1:4.5", "--skip", "3.1,3.4", "-o", case], check=True)
    return case


def figure_21(case):
    with open(case / "quality.csv") as file:
        rows = list(csv.DictReader(file))
    t = [float(r["t"]) for r in rows]
    figure, axis = plt.subplots(figsize=(5.4, 3))
    axis.plot(t, [float(r["min_q"]) for r in rows], "o-", ms=3, lw=.8, color="tab:green", label="least Q")
    axis.plot(t, [float(r["q_01"]) for r in rows], "o-", ms=3, lw=.8, color="tab:blue", label="Q that 1 % of the tets are below")
    axis.axhline(.615, color="tab:gray", lw=1, label="least Q over all instants in the paper")
    axis.set(xlabel="t", ylim=(.5, 1), title="eq. (13), one background")
    axis.legend()
    figure.tight_layout()
    save(figure, "figure_21.svg")


def stroke(data, swimmer):
    """The folder of one stroke of the swimmer."""
    folder = data / "stroke"
    if not (folder / "fields" / "016.vtu").exists():
        subprocess.run([swimmer, "-o", folder], check=True)
    return folder


def figure_25(folder):
    """At t0 + 7 dt, in the plane x = 0: the flow of the deformation, and that of the translation."""
    plane, cutter = vtkPlane(), vtkCutter()
    plane.SetNormal(1, 0, 0)
    cutter.SetCutFunction(plane)
    cutter.SetInputData(Mesh(folder / "fields" / "007.vtu").grid)
    cutter.Update()
    cut = cutter.GetOutput()
    y, z = vtk_to_numpy(cut.GetPoints().GetData()).T[1:]
    triangles = vtk_to_numpy(cut.GetPolys().GetConnectivityArray()).reshape(-1, 3)
    value = {cut.GetPointData().GetArrayName(i): vtk_to_numpy(cut.GetPointData().GetArray(i))
             for i in range(cut.GetPointData().GetNumberOfArrays())}
    figure, axes = plt.subplots(4, 1, figsize=(7, 8.4), sharex=True)
    panels = (("u_phi_z", "axial velocity, deformation"), ("p_phi", "pressure, deformation"),
              ("u_z_z", "axial velocity, translation"), ("p_z", "pressure, translation"))
    for axis, (name, title) in zip(axes, panels):
        # The greatest pressures are at single points of the crease.
        most = np.quantile(np.abs(value[name]), .998)
        filled = axis.tricontourf(z, y, triangles, np.clip(value[name], -most, most), 20, cmap="RdBu_r", vmin=-most, vmax=most)
        for collection in filled.collections:
            collection.set_rasterized(True)  # a twentieth of the bytes
        figure.colorbar(filled, ax=axis, shrink=.9, pad=.01, format="%.2g")
        axis.set(title=title, aspect="equal", ylabel="y")
        axis.grid(False)
    axes[-1].set_xlabel("z")
    figure.tight_layout()
    save(figure, "figure_25.svg")


def figure_26(folder):
    with open(folder / "swimmer.csv") as file:
        rows = list(csv.DictReader(file))
    figure, axes = plt.subplots(1, 2, figsize=(8, 3))
    for axis, key, title in ((axes[0], "velocity", "velocity"), (axes[1], "z0", "position")):
        axis.plot([float(r["t"]) for r in rows], [float(r[key]) for r in rows], "o-", ms=3, lw=.8, color="tab:blue")
        axis.set(title=f"{title} of the swimmer along the channel", xlabel="t")
    figure.tight_layout()
    save(figure, "figure_26.svg")


def timings(data, programs, most):
    """One row per mesh: figure_18.csv, which is continued where it ends."""
    path = data / "figure_18.csv"
    rows = [] if not path.exists() else [dict(r) for r in csv.DictReader(path.open())]
    n = 250_000
    while n <= most:
        for shape in GENUS:
            if not any(r["shape"] == shape and int(r["asked"]) == n for r in rows):
                command = [programs / "peer_umtet", shape, str(n), "crawl", data / "figure_18.msh"]
                made = json.loads(subprocess.run(command, check=True, capture_output=True, text=True).stdout)
                if made["genus"] != GENUS[shape] or made["failures"]:
                    raise RuntimeError(f"{shape} at {n} tets: {made}")
                rows.append({"shape": shape, "asked": n, **{k: made[k] for k in made if k not in ("failures", "pieces")}})
                with path.open("w", newline="") as file:
                    writer = csv.DictWriter(file, rows[0])
                    writer.writeheader()
                    writer.writerows(rows)
        n *= 2
    (data / "figure_18.msh").unlink(missing_ok=True)
    return rows


def figure_18(data, programs, most):
    rows = timings(data, programs, most)
    figure, axis = plt.subplots(figsize=(5.4, 4))
    faces, seconds, tets = (np.array([float(r[k]) for r in rows]) for k in ("positive_faces", "mesh_s", "tets"))
    slope, at_one = np.polyfit(np.log(faces), np.log(seconds), 1)
    for shape, genus in GENUS.items():
        of = [k for k, r in enumerate(rows) if r["shape"] == shape]
        axis.plot(faces[of], seconds[of], "o", ms=4, label=f"genus {genus}")
        print(f"{shape}: exponent {np.polyfit(np.log(faces[of]), np.log(seconds[of]), 1)[0]:.3f}")
    x = np.array([faces.min(), faces.max()])
    axis.plot(x, np.exp(at_one) * x**slope, "k-", lw=.8, label=f"exponent {slope:.2f}")
    axis.set(xscale="log", yscale="log", xlabel="positive faces", ylabel="CPU s, one thread",
             title=f"{tets.min() / 1e6:.2f} to {tets.max() / 1e6:.1f} million tets")
    axis.legend()
    figure.tight_layout()
    save(figure, "figure_18.svg")
    work = np.linalg.lstsq(np.c_[faces, tets], seconds, rcond=None)[0] * 1e6
    large = tets > .9 * most
    held, written = (np.array([float(r[k]) for r in rows])[large] / tets[large] * 1e6 for k in ("mesh_MB", "all_MB"))
    print(f"all: exponent {slope:.3f}; {1e6 * (seconds / faces).min():.1f} to {1e6 * (seconds / faces).max():.1f} us per "
          f"positive face; {work[0]:.2f} us a face + {work[1]:.3f} us a tet\nthe largest: mesher {held.min():.0f} to "
          f"{held.max():.0f} MB per million tets, process with certificate and file {written.min():.0f} to "
          f"{written.max():.0f}")


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    build = ROOT / "build"
    parser.add_argument("--data", type=Path, default=build / "figures")
    parser.add_argument("--peers", type=Path, default=build / "peers")
    parser.add_argument("--programs", type=Path, default=build / "release/tests/bench/peers")
    parser.add_argument("--umtet", type=Path, default=build / "release/pipeline/umtet")
    parser.add_argument("--swimmer", type=Path, default=build / "release/examples/swimmer/umtet_swimmer")
    parser.add_argument("--most", type=int, default=8_000_000, help="tets of the largest meshes of Figure 18")
    parser.add_argument("--only", help="these figures: 14,24")
    args = parser.parse_args()
    args.data.mkdir(parents=True, exist_ok=True)
    data = args.data
    figures = {
        8: lambda: figure_8(data, args.umtet),
        14: lambda: drawn_figures.figure_14(data, args.umtet),
        15: lambda: figure_15(data, args.umtet),
        19: lambda: drawn_figures.figure_19(data, args.umtet),
        20: lambda: drawn_figures.figure_20(equation_13(data, args.umtet)),
        21: lambda: figure_21(equation_13(data, args.umtet)),
        24: lambda: drawn_figures.figure_24(stroke(data, args.swimmer)),
        25: lambda: figure_25(stroke(data, args.swimmer)),
        26: lambda: figure_26(stroke(data, args.swimmer)),
        18: lambda: figure_18(data, args.programs, args.most),
        10: lambda: figure_10(args.peers, args.programs),
    }
    for number in [int(n) for n in args.only.split(",")] if args.only else figures:
        figures[number]()


if __name__ == "__main__":
    main()
