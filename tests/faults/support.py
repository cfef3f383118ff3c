"""What the tests of faults share: small clouds, calls of the program from outside, and what a case holds."""
import json
import math
import os
import pathlib
import shutil
import subprocess
import tempfile
import time

PROGRAM = os.environ.get("UMTET_PROGRAM", "umtet")
SHIM = os.environ.get("UMTET_FAULT_SHIM", "")
SLOW = bool(os.environ.get("UMTET_SLOW"))
# Seconds, for what takes one: only what hangs is found, however busy the machine is.
PATIENT = 600


def ellipsoid(n, axes=(1, .8, .6)):
    """Lines x y z nx ny nz of n points of an ellipsoid with these half axes."""
    lines = []
    for i in range(n):
        z = 1 - (2 * i + 1) / n
        r, a = math.sqrt(1 - z * z), 2.399963229728653 * i
        u = (r * math.cos(a), r * math.sin(a), z)
        x = [axes[k] * u[k] for k in range(3)]
        g = [u[k] / axes[k] for k in range(3)]
        length = math.sqrt(sum(c * c for c in g))
        lines.append(" ".join(repr(c) for c in x + [c / length for c in g]))
    return lines


def write_ply(path, lines, count=None):
    head = ["ply", "format ascii 1.0", f"element vertex {len(lines) if count is None else count}"]
    head += [f"property double {p}" for p in ("x", "y", "z", "nx", "ny", "nz")] + ["end_header"]
    with open(path, "w") as file:
        file.write("\n".join(head + lines) + "\n")
    return path


def run(*arguments, env=None, cwd=None, timeout=PATIENT, **options):
    """The finished process, with texts; a crash has a negative returncode."""
    return subprocess.run([PROGRAM, *map(str, arguments)], env={**os.environ, **(env or {})}, cwd=cwd, timeout=timeout,
                          stdin=subprocess.DEVNULL, stdout=options.pop("stdout", subprocess.PIPE),
                          stderr=subprocess.PIPE, encoding="utf-8", errors="replace", **options)


def promised(case):
    """Every file of a case that a second run must give again byte by byte, documents without their block `run`, and not the report, which shows that block.

    Not those under the names of temporary files and folders, which a killed run may leave and the next one removes."""
    found = {}
    for file in sorted(pathlib.Path(case).rglob("*")):
        name = str(file.relative_to(case))
        if not file.is_file() or file.name in (".lock", "case.toml", "report.html") or "/.tmp-" in "/" + name or name.startswith((".next", "3-mesh/failed")):
            continue
        content = file.read_bytes()
        if file.suffix == ".json":
            document = json.loads(content)
            if name == "failure.json":  # whole, but another one after each fault
                continue
            document.pop("run", None)
            content = json.dumps(document).encode()
        found[name] = content
    return found


def wait_until(condition):
    """What the condition gives as soon as it is true; the last it gave where it never is."""
    end = time.monotonic() + PATIENT
    while not (found := condition()) and time.monotonic() < end:
        time.sleep(.01)
    return found


class Folder:
    """A new folder that is gone afterwards."""

    def __enter__(self):
        self.path = pathlib.Path(tempfile.mkdtemp(prefix="umtet_faults_"))
        return self.path

    def __exit__(self, *_):
        shutil.rmtree(self.path, ignore_errors=True)
