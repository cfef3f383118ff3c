#!/usr/bin/python3
"""Whether a phase of a mesh costs more than what is stored.

usage: gate.py PHASE_BENCH [--reference FILE] [--write] [--only REGEX]

The cost of a phase is what callgrind counts, Ir + 10 L1m + 100 LLm: instructions and misses of a first and a last cache
that are simulated, the estimate of cycles of KCachegrind. It is the same on every machine that has the same compiler and
libraries, where CPU times of a rented one vary by a factor of two. FILE (phases.json here) has, for each phase, the cost
and the spread, (greatest - least) / median, of RUNS runs. A phase costs more if it is beyond 1 + SPREADS spreads, and
1 + LEAST, in each of three runs; one that is not is not asked again.

--write stores what this tree costs; with --only the phases that do not match keep what is stored. Exit 1: a phase costs more, it is named.
"""
import argparse
import json
import pathlib
import statistics
import subprocess
import sys
import tempfile

RUNS = 3
SPREADS = 3
CACHES = ("--I1=32768,8,64", "--D1=32768,8,64", "--LL=8388608,16,64")  # and not those of the machine at hand
LEAST = .05
EVERY = ".*"


def costs(program, only):
    """Of one run: phase -> cost."""
    with tempfile.TemporaryDirectory() as folder:
        subprocess.run(["valgrind", "--tool=callgrind", "--instr-atstart=no", "--cache-sim=yes",
                        *CACHES, f"--callgrind-out-file={folder}/out", program, only], capture_output=True, check=True)
        return dict(filter(None, map(cost_in, pathlib.Path(folder).iterdir())))


def cost_in(file):
    """(phase, cost) of a dump; None of the last one, which is of the end of the program."""
    lines = file.read_text(errors="replace").splitlines()
    value = {key: text.strip() for key, colon, text in (line.partition(":") for line in lines) if colon and "=" not in key}
    phase = next((line.partition("Client Request: ")[2] for line in lines if "Client Request: " in line), "")
    if not phase:
        return None
    n = dict(zip(value["events"].split(), map(int, value["summary"].split())))
    misses = {level: sum(n[e] for e in n if e[1:2] == level and e.endswith(("mr", "mw"))) for level in "1L"}
    return phase, n["Ir"] + 10 * misses["1"] + 100 * misses["L"]


def measured(program, only):
    runs = [costs(program, only) for _ in range(RUNS)]
    rows = {}
    for phase in sorted(runs[0]):
        values = [run[phase] for run in runs]
        middle = statistics.median(values)
        rows[phase] = {"cost": middle, "spread": round((max(values) - min(values)) / middle, 4)}
    return rows


def dearer_phases(program, only, stored):
    """Phase -> cost over that stored, of the last run; empty if a run finds none."""
    found = dict.fromkeys(stored)
    for _ in range(3):
        now = costs(program, only)
        missing = set(now) - set(stored)
        if missing:
            raise SystemExit(f"nothing is stored for {', '.join(sorted(missing))}: --write does it")
        factors = {phase: now[phase] / stored[phase]["cost"] for phase in found if phase in now}
        found = {p: f for p, f in factors.items() if f > 1 + max(LEAST, SPREADS * stored[p]["spread"])}
        if not found:
            break
    return found


def main():
    parser = argparse.ArgumentParser()
    parser.add_argument("program")
    parser.add_argument("--reference", type=pathlib.Path, default=pathlib.Path(__file__).with_name("phases.json"))
    parser.add_argument("--write", action="store_true")
    parser.add_argument("--only", default=EVERY, help="phases whose names match")
    options = parser.parse_args()
    if options.write:
        keeps = options.only != EVERY and options.reference.exists()
        others = json.loads(options.reference.read_text()) if keeps else {}
        options.reference.write_text(json.dumps({**others, **measured(options.program, options.only)}, indent=1) + "\n")
        return 0
    stored = json.loads(options.reference.read_text())
    found = dearer_phases(options.program, options.only, stored)
    for phase, factor in found.items():
        print(f"{phase}: costs {100 * (factor - 1):.1f} % more than what is stored, in each of three runs")
    if not found:
        print(f"no phase costs more than what is stored: {', '.join(sorted(stored))}")
    return 1 if found else 0


if __name__ == "__main__":
    sys.exit(main())
