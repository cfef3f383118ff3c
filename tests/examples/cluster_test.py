"""examples/cluster: a workflow and arrays of jobs over a folder of cases, and one table. cluster_test.py, with UMTET_PROGRAM and UMTET_SOURCE set.

The workflow runs where snakemake is installed; sbatch is a stand-in that runs the tasks of an array one after the other."""
import csv
import json
import os
import pathlib
import re
import shutil
import subprocess
import sys
import unittest

SOURCE = pathlib.Path(os.environ["UMTET_SOURCE"])
CLUSTER, CLOUDS = SOURCE / "examples/cluster", SOURCE / "data/clouds"
sys.path[:0] = [str(SOURCE / "tests/faults"), str(CLUSTER)]
import scans  # noqa: E402
from support import PATIENT, PROGRAM, Folder, ellipsoid, promised, run, write_ply  # noqa: E402

FEW = "--tets 2000"
# A program whose first run of every case ends as one that had too little memory; what it is called with is kept.
FAILS_ONCE = """#!/bin/sh
if [ "$1" = run ] && [ ! -e "$4.tried" ]; then touch "$4.tried"; exit 9; fi
exec {program} "$@"
"""
# $SBATCH_LOG has a line for every call.
SBATCH = """#!/usr/bin/python3
import os, subprocess, sys
words = sys.argv[1:]
print(*words, file=open(os.environ["SBATCH_LOG"], "a"))
flags = dict(w[2:].split("=", 1) for w in words if w.startswith("--") and "=" in w[:20])
if "--wrap" in words:
    subprocess.run(words[words.index("--wrap") + 1], shell=True)
else:
    script = next(k for k, w in enumerate(words) if not w.startswith("--"))
    exported = dict(e.split("=", 1) for e in flags["export"].split(",")[1:])
    for task in flags["array"].split(","):
        env = dict(os.environ, SLURM_ARRAY_TASK_ID=task, SLURM_CPUS_PER_TASK=flags["cpus-per-task"], **exported)
        subprocess.run(words[script:], env=env)
print("17")
"""


def three_scans(folder):
    """A duck, an egg and a file that is no cloud, in a list."""
    write_ply(folder / "an egg.ply", ellipsoid(300))
    (folder / "text.ply").write_text("this is no cloud\n")
    (folder / "list").write_text(f"# scans\n{CLOUDS}/duck.ply\nan egg.ply\ntext.ply\n")


def table(folder):
    with open(folder / "batch.csv", newline="", encoding="utf-8") as file:
        return {row["case"]: row for row in csv.DictReader(file)}


def stages_run(folder, name):
    return json.loads((folder / f"logs/{name}.json").read_text()).get("stages_run")


class Cluster(unittest.TestCase):
    def check_table(self, folder):
        rows = table(folder)
        self.assertEqual({n: r["exit_code"] for n, r in rows.items()}, {"duck": "0", "an egg": "0", "text": "3"})
        self.assertIn("text.ply", rows["text"]["reason"])
        self.assertGreater(float(rows["duck"]["seconds"]), 0)
        self.assertGreater(float(rows["duck"]["peak_memory_MB"]), 10)
        self.assertEqual((folder / "batch.html").read_text().count("<tr>"), 4)

    def test_a_scan_that_waits_or_was_cut_off_is_no_verdict(self):
        with Folder() as folder:
            three_scans(folder)
            self.assertEqual(run("batch", "list", "-o", "out", "--collect", cwd=folder).returncode, 2)
            (folder / "out/logs").mkdir(parents=True)
            (folder / "out/logs/duck.json").write_text('{"exit_code": 0')
            self.assertEqual(run("batch", "list", "-o", "out", "--collect", cwd=folder).returncode, 6)
            rows = table(folder / "out")
            self.assertEqual([r["verdict"] for r in rows.values()], ["waiting"] * 3)
            self.assertIn("incomplete", rows["duck"]["reason"])
            self.assertEqual([p.name for p in (folder / "out").iterdir() if p.is_dir()], ["logs"])  # nothing was run
            self.assertEqual(run("batch", "list", "-o", "out", "--collect", "--resume", cwd=folder).returncode, 2)

    def test_predictions_hold_on_the_clouds_of_the_repository(self):
        with Folder() as folder:
            for cloud in sorted(CLOUDS.glob("*.ply")):
                inspection = json.loads(run("inspect", cloud, "--json").stdout)["inspection"]["prediction"]
                made = json.loads(run("run", cloud, "-o", folder / cloud.stem, "--threads", 1, "--no-report", "--json").stdout)
                certificate, expected = made["certificate"], inspection["expected"]
                with self.subTest(cloud=cloud.name):
                    self.assertLess(abs(expected["n_tets"] / certificate["n_tets"] - 1), .35)
                    peak = certificate["run"]["peak_memory_MB"]
                    self.assertLess(peak, inspection["most"]["memory_MB"])
                    self.assertLess(peak, scans.MARGIN * expected["memory_MB"])
                    self.assertLess(expected["memory_MB"], 4 * peak)

    def test_a_prediction_follows_what_the_run_is_asked_for(self):
        duck = CLOUDS / "duck.ply"

        def predicted(*flags):
            return json.loads(run("inspect", duck, *flags, "--json").stdout)["inspection"]["prediction"]
        few, many, fine = predicted("--tets", 10000), predicted("--tets", 1000000), predicted("--h", .01)
        self.assertAlmostEqual(few["expected"]["n_tets"], 10000, delta=10)
        self.assertGreater(many["expected"]["memory_MB"], few["expected"]["memory_MB"] + 300)
        self.assertEqual(fine["h"], .01)
        self.assertEqual(predicted("--set", "mesh.tets=10000"), few)
        self.assertLessEqual(predicted("--max-tets", 20000)["most"]["n_tets"], 20001)

    def snakemake(self, folder, *config, program=PROGRAM):
        call = subprocess.run(["snakemake", "-s", str(CLUSTER / "Snakefile"), "--cores", "2", "--config", "list=list", "folder=out",
                               f"umtet={program}", *config], cwd=folder, capture_output=True, text=True, timeout=PATIENT,
                              env={**os.environ, "XDG_CACHE_HOME": str(folder / "cache")})
        self.assertEqual(call.returncode, 0, call.stdout + call.stderr)
        return call.stderr

    @unittest.skipUnless(shutil.which("snakemake"), "snakemake is not installed")
    def test_the_workflow_makes_every_scan_once_and_a_table(self):
        with Folder() as folder:
            three_scans(folder)
            self.snakemake(folder, f"parameters={FEW}", "options=--no-report")
            self.check_table(folder / "out")
            whole = promised(folder / "out/duck")
            self.assertIn("Nothing to be done", self.snakemake(folder, f"parameters={FEW}", "options=--no-report"))
            # What was stopped goes on from the records of its case; here all of it is finished.
            for answer in ("logs/duck.json", "batch.html"):
                (folder / "out" / answer).unlink()
            self.snakemake(folder, f"parameters={FEW}", "options=--no-report")
            self.assertEqual(stages_run(folder / "out", "duck"), [])
            self.assertEqual(promised(folder / "out/duck"), whole)
            # Other parameters: the same cloud and level set, another mesh.
            self.snakemake(folder, "parameters=--tets 3000", "options=--no-report")
            self.assertEqual(stages_run(folder / "out", "duck"), ["mesh"])
            self.check_table(folder / "out")

    @unittest.skipUnless(shutil.which("snakemake"), "snakemake is not installed")
    def test_a_scan_that_lacks_memory_is_tried_again_with_more(self):
        with Folder() as folder:
            write_ply(folder / "egg.ply", ellipsoid(300))
            (folder / "list").write_text("egg.ply\n")
            program = folder / "fails_once"
            program.write_text(FAILS_ONCE.format(program=PROGRAM))
            program.chmod(0o755)
            said = self.snakemake(folder, "parameters=--tets 300000", program=program)
            asked = [int(m) for m in re.findall(r"rule scan:.*?mem_mb=(\d+)", said, re.S)]
            self.assertEqual(len(asked), 2, said)
            self.assertGreater(asked[1], 2 * asked[0])
            self.assertEqual(table(folder / "out")["egg"]["verdict"], "pass")

    def test_arrays_of_jobs_make_every_scan_and_a_table(self):
        with Folder() as folder:
            three_scans(folder)
            (folder / "bin").mkdir()
            (folder / "bin/sbatch").write_text(SBATCH)
            (folder / "bin/sbatch").chmod(0o755)
            env = {**os.environ, "PATH": f"{folder / 'bin'}:{os.environ['PATH']}", "SBATCH_LOG": str(folder / "calls"), "PYTHONDONTWRITEBYTECODE": "1"}

            def submit(*words):
                before = (folder / "calls").read_text() if (folder / "calls").exists() else ""
                call = subprocess.run([sys.executable, str(CLUSTER / "submit.py"), "list", "-o", "out", "--umtet", PROGRAM, "--parameters", FEW, *words],
                                      cwd=folder, env=env, capture_output=True, text=True, timeout=PATIENT)
                self.assertEqual(call.returncode, 0, call.stdout + call.stderr)
                return (folder / "calls").read_text()[len(before):].splitlines() if (folder / "calls").exists() else []
            self.assertEqual(submit("--print"), [])
            calls = submit("--options=--no-report")
            self.assertEqual(len(calls), 2)  # three small scans are one array
            self.assertIn("--array=1,2,3 --mem=256M --time=2 ", calls[0])
            self.assertIn("--dependency=afterany:17 ", calls[1])
            self.check_table(folder / "out")
            # The same again: scans with a verdict, that of a refused one included, are not submitted.
            self.assertEqual(len(submit()), 1)
            (folder / "out/logs/an egg.json").write_text("")
            self.assertIn("--array=2 ", submit("--options=--no-report")[0])
            self.assertEqual(stages_run(folder / "out", "an egg"), [])
            self.check_table(folder / "out")

    def test_two_scans_of_one_name_are_refused(self):
        with Folder() as folder:
            (folder / "list").write_text("a/scan.ply\nb/scan.ply\n")
            with self.assertRaises(ValueError):
                scans.listed(folder / "list")


if __name__ == "__main__":
    unittest.main()
