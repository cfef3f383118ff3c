"""Runs umtet and CGAL's Poisson reconstruction, and reads what they leave: seconds, numbers, surfaces, distances."""
import json
import math
import os
import resource
import shutil
import signal
import subprocess
from typing import NamedTuple

import numpy as np

import triangle_mesh

TIMEOUT = 124  # exit code of a run that took too long
USAGE = 2  # exit code of a flag that the program does not have
IMAGES = (".nii", ".nii.gz", ".nrrd", ".vti", ".vtk")


class Run(NamedTuple):
    code: int
    cpu: float  # seconds
    stderr: str

    def error(self):
        """What umtet says of a failure; empty after exit 0."""
        if self.code == 0:
            return ""
        lines = self.stderr.strip().splitlines() or [""]
        return next((line for line in lines if line.startswith("umtet:")), lines[-1])


def limited(timeout):
    """For subprocess.run: an end after so many seconds of CPU, which a busy machine does not change; and, where nothing is
    computed, after twenty times as many of the clock."""
    if timeout is None:
        return {}
    seconds = math.ceil(timeout)
    return {"timeout": 20 * timeout,
            "preexec_fn": lambda: resource.setrlimit(resource.RLIMIT_CPU, (seconds, seconds + 5))}


def timed(command, timeout=None):
    """@param timeout  seconds of CPU"""
    before = os.times()
    try:
        done = subprocess.run([str(word) for word in command], stdout=subprocess.DEVNULL, stderr=subprocess.PIPE,
                              text=True, errors="replace", check=False, **limited(timeout))
        code, stderr = done.returncode, done.stderr
    except subprocess.TimeoutExpired:
        code, stderr = TIMEOUT, ""
    if code in (TIMEOUT, -signal.SIGXCPU):
        code, stderr = TIMEOUT, f"more than {timeout:g} s"
    after = os.times()
    cpu = after.children_user + after.children_system - before.children_user - before.children_system
    return Run(code, cpu, stderr)


def run(umtet, cloud, case, more=(), timeout=None):
    """umtet run into a new folder; one that is there is deleted."""
    shutil.rmtree(case, ignore_errors=True)
    return timed([umtet, "run", cloud, "-o", case, "--no-report", "--progress", "none", *more], timeout)


def words_for(file):
    """The command that makes a mesh of a file, without -o."""
    return ["mesh", "--level-set", file] if str(file).lower().endswith(IMAGES) else ["run", file]


def run_first(umtet, words, alternatives, case, timeout=None):
    """umtet into a new folder, with the first of several lists of flags that the program knows."""
    done = None
    for flags in alternatives:
        shutil.rmtree(case, ignore_errors=True)
        done = timed([umtet, *words, *flags, "-o", case, "--no-report", "--progress", "none"], timeout)
        if done.code != USAGE:
            break
    return done


def forecast(umtet, file, timeout=None):
    """What `umtet inspect` expects of a run: tets, seconds and MB; None where it expects nothing."""
    try:
        done = subprocess.run([str(umtet), "inspect", str(file), "--json", "--progress", "none"], capture_output=True,
                              text=True, errors="replace", check=False, **limited(timeout))
        expected = json.loads(done.stdout)["inspection"]["prediction"]["expected"]
        return expected["n_tets"], expected["seconds"], expected["memory_MB"]
    except (subprocess.TimeoutExpired, KeyError, ValueError):
        return None


def number(case, file, *keys):
    """What a JSON file of the case says; None where it says nothing."""
    try:
        with open(os.path.join(case, file), encoding="utf8") as f:
            value = json.load(f)
        for key in keys:
            value = value[key]
        return value
    except (OSError, KeyError, TypeError, ValueError):
        return None


def certified(case, *keys):
    return number(case, "certificate.json", *keys)


def reason(done, case):
    """Why a run failed, in the words of the certificate or of umtet; empty after exit 0."""
    reasons = certified(case, "reasons") if done.code else None
    return (reasons[0] if reasons else done.error())[:120]


def boundary(umtet, case):
    """Triangles of the mesh's boundary, or None."""
    if certified(case) is None:
        return None
    timed([umtet, "export", case, "--format", "ply", "-q"])
    mesh = triangle_mesh.read(os.path.join(case, "4-export", "mesh.ply"))
    return mesh if mesh.GetNumberOfPolys() else None


def poisson(program, cloud, file, timeout=None):
    """The run of CGAL's Poisson reconstruction (cgal_poisson.cpp), and its triangles or None."""
    if os.path.exists(file):
        os.remove(file)
    done = timed([program, cloud, file], timeout)
    mesh = triangle_mesh.read(file) if done.code == 0 and os.path.exists(file) else None
    return done, mesh if mesh and mesh.GetNumberOfPolys() else None


def both_distances(body, mesh, n=50_000):
    """Of the mesh's vertices to the body, and of n random points of the body to the mesh's triangles, over the body's
    diagonal; none of a mesh that is None."""
    if mesh is None:
        return np.array([np.nan]), np.array([np.nan])
    there = body.distance(triangle_mesh.corners(mesh)[0])
    back = triangle_mesh.distances(body.sample(n, 9)[0], mesh)
    return there / body.diagonal(), back / body.diagonal()


def rms_angle(body, mesh, here=lambda x: np.ones(len(x), bool)):
    """Degrees between the mesh's faces and the body, by area, of faces whose middle is here."""
    middles, crosses = triangle_mesh.middles_and_crosses(mesh)
    counted = here(middles)
    middles, crosses = middles[counted], crosses[counted]
    area = np.linalg.norm(crosses, axis=1)
    cosine = np.clip(np.sum(crosses * body.foot(middles)[1], 1) / area, -1, 1)
    return np.sqrt(np.sum(area * np.degrees(np.arccos(cosine))**2) / np.sum(area))


def shown(value, width, form=""):
    """A number, or - where there is none."""
    missing = value is None or value != value
    return f"{'-' if missing else format(value, form):>{width}}"
