"""What the workflow and the array script share: the scans of a list, the names of their cases, and what to ask a scheduler for."""
import json
import math
import pathlib

# Machines differ from the one that predictions are measured on, and so do scans of one size.
MARGIN = 1.5
LEAST_MB, LEAST_MINUTES = 256, 2
# Exit codes of `umtet run` that another try would only repeat: the scan is a row of the table.
SETTLED = (0, 3, 4, 5, 6)

# Names of files in the folder of the cases.
TAKEN = ("logs", "batch.csv", "batch.html", "batch.json")


def listed(path):
    """{name of the case: scan}, of a text file with the path of a scan a line, relative to the file; # begins a comment.

    The names are those of `umtet batch`. ValueError for two scans of one name."""
    path = pathlib.Path(path)
    found = {}
    for line in path.read_text().splitlines():
        line = line.rstrip()
        if not line or line.startswith("#"):
            continue
        scan = path.absolute().parent / line
        if scan.stem in found or scan.stem in TAKEN or scan.stem.startswith("."):
            raise ValueError(f"{path}: {scan}: no second case may have the name {scan.stem}: rename the file")
        found[scan.stem] = scan
    return found


def resources(inspection, attempt=1, threads=1):
    """Megabytes and minutes to ask for: those expected for one mesh; from the second attempt on the most, doubled each time.

    inspection: a file with the answer of `umtet inspect --json`. A scan that was refused there is refused again soon."""
    answer = json.loads(pathlib.Path(inspection).read_text())
    run = answer.get("inspection", {}).get("prediction")
    if not run:
        return {"mem_mb": LEAST_MB, "minutes": LEAST_MINUTES}
    cost = run["expected"] if attempt == 1 else run["most"]
    factor = MARGIN * 2 ** max(0, attempt - 2)
    return {"mem_mb": max(LEAST_MB, math.ceil(factor * cost["memory_MB"])),
            "minutes": max(LEAST_MINUTES, math.ceil(factor * cost["seconds"] / 60 / threads ** .5))}
