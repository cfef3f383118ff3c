"""`mpirun -n N umtet_mpi` where something goes wrong in one process: one reason, the exit code of one process, no hang.

usage: faults_test.py UMTET_MPI THROWING_RANK KILL_SHIM MPIEXEC N
"""
import json
import os
import pathlib
import shutil
import signal
import subprocess
import sys
import tempfile
import time
import unittest

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parents[1] / "faults"))
from support import ellipsoid, write_ply  # noqa: E402

UMTET_MPI, THROWING_RANK, KILL_SHIM, MPIEXEC, N = *sys.argv[1:5], int(sys.argv[5])
BALL = ["--implicit", "x^2+y^2+z^2-1", "--box=-1.2,-1.2,-1.2,1.2,1.2,1.2", "--threads", "1", "--no-report", "--progress", "none"]
# Some six seconds of one process: a signal comes after one of them, and mpirun may take two before it ends what it started.
LONG = [*BALL, "--h", ".019", "--max-tets", "1e7"]
PATIENT = 120  # seconds, for what takes some: only what hangs is found


def command(folder, arguments, of_last="", n=N):
    """The last process runs `of_last`, a command of the shell, before it becomes the program."""
    script = f'if [ "$OMPI_COMM_WORLD_RANK" = {n - 1} ]; then {of_last or ":"}; fi; exec "$@"'
    return [MPIEXEC, "-n", str(n), "--oversubscribe", "sh", "-c", script, "sh", UMTET_MPI, "mesh", *arguments, "-o", str(folder)]


def said(text):
    """Lines of the program, without those of mpirun."""
    return [line for line in text.splitlines() if line.startswith("umtet: ")]


class Faults(unittest.TestCase):
    def setUp(self):
        self.folder = pathlib.Path(tempfile.mkdtemp(prefix="umtet_mpi_faults_"))
        self.addCleanup(shutil.rmtree, self.folder, ignore_errors=True)
        self.case = self.folder / "case"

    def run_with(self, arguments, of_last="", n=N):
        return subprocess.run(command(self.case, arguments, of_last, n), capture_output=True, text=True, timeout=PATIENT)

    def stopped(self, how, rank):
        """A signal to one process, while the mesh is made; to mpirun without a rank."""
        pids = self.folder / "pid"
        script = f'echo $$ > {pids}_$OMPI_COMM_WORLD_RANK; exec "$@"'
        call = [MPIEXEC, "-n", str(N), "--oversubscribe", "sh", "-c", script, "sh", UMTET_MPI, "mesh", *LONG, "--json", "-o", str(self.case)]
        process = subprocess.Popen(call, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True)
        end = time.monotonic() + PATIENT
        while not (self.case / ".lock").exists() and time.monotonic() < end:
            time.sleep(.05)
        time.sleep(1)  # in the mesh
        os.kill(process.pid if rank is None else int(pathlib.Path(f"{pids}_{rank}").read_text()), how)
        start = time.monotonic()
        out, err = process.communicate(timeout=PATIENT)
        self.assertLess(time.monotonic() - start, 20)
        self.assertFalse((self.case / "3-mesh/record.json").exists(), "it had ended before")
        return process.returncode, out, said(err)

    def test_signals_to_one_process_end_all_with_its_reason(self):
        for how, code, word in ((signal.SIGINT, 130, "interrupted"), (signal.SIGTERM, 143, "terminated")):
            for rank in sorted({0, N - 1}):
                with self.subTest(word, rank=rank):
                    found, out, lines = self.stopped(how, rank)
                    self.assertEqual(found, code, lines)
                    self.assertEqual(len(lines), 1, lines)
                    self.assertIn(f"{word} in mesh", lines[0])
                    if rank == 0:
                        self.assertEqual(json.loads(out)["exit_code"], code)

    def test_a_signal_while_all_fit_ends_all_with_its_reason(self):
        if N == 1:
            self.skipTest("one process")
        cloud = write_ply(self.folder / "egg.ply", ellipsoid(4000))
        for how, code, word in ((signal.SIGINT, 130, "interrupted"), (signal.SIGTERM, 143, "terminated")):
            with self.subTest(word):
                # The second iteration on a band: it alone waits for blocks of others.
                hook = ["LD_PRELOAD=" + KILL_SHIM, "UMTET_KILL_RANK=0", "UMTET_KILL_STEP=Waitall", "UMTET_KILL_AT=2", f"UMTET_KILL_SIGNAL={int(how)}"]
                made = subprocess.run([MPIEXEC, "-n", str(N), "--oversubscribe", "env", *hook, UMTET_MPI, "reconstruct", str(cloud), "--set", "reconstruct.spacing=.03", "--threads", "1", "--progress", "none", "--json", "-o", str(self.case)],
                                      capture_output=True, text=True, timeout=PATIENT)
                self.assertEqual(made.returncode, code, made.stderr)
                self.assertEqual(said(made.stderr), [f"umtet: {word} in level-set; the case can be resumed with the same command"])
                self.assertEqual(json.loads(made.stdout)["exit_code"], code)

    def test_a_signal_to_mpirun_ends_all_and_the_case_can_be_resumed(self):
        found, _, lines = self.stopped(signal.SIGTERM, None)
        self.assertNotEqual(found, 0)  # that of mpirun, which may leave no time for a word
        self.assertLessEqual(len(lines), 1, lines)
        arguments = [*BALL, "--h", ".2"]
        self.assertEqual(self.run_with(arguments).returncode, 0)
        self.assertFalse([f for f in self.case.rglob(".tmp-*")])

    def test_processes_end_where_mpirun_is_killed(self):
        self.stopped(signal.SIGKILL, None)
        pids = [int(f.read_text()) for f in self.folder.glob("pid_*")]
        self.assertEqual(len(pids), N)
        end = time.monotonic() + 20
        while any(pathlib.Path(f"/proc/{pid}").exists() for pid in pids) and time.monotonic() < end:
            time.sleep(.05)
        self.assertEqual([pid for pid in pids if pathlib.Path(f"/proc/{pid}").exists()], [])
        self.assertEqual(self.run_with([*BALL, "--h", ".2"]).returncode, 0)
        self.assertFalse([f for f in self.case.rglob(".tmp-*")])

    def test_processes_that_were_called_differently_say_what_differs(self):
        if N == 1:
            self.skipTest("one process")
        files = {rank: self.folder / f"{rank}.toml" for rank in ("first", "last")}
        files["first"].write_text("[mesh]\nh = 0.2\n")
        files["last"].write_text("[mesh]\nh = 0.25\n")
        script = f'if [ "$OMPI_COMM_WORLD_RANK" = {N - 1} ]; then f={files["last"]}; else f={files["first"]}; fi; exec "$@" --config $f'
        made = subprocess.run([MPIEXEC, "-n", str(N), "--oversubscribe", "sh", "-c", script, "sh", UMTET_MPI, "mesh", *BALL, "-o", str(self.case)],
                              capture_output=True, text=True, timeout=PATIENT)
        self.assertEqual(made.returncode, 2, made.stderr)
        difference = f"umtet: processes were called for different meshes: h is 0.2 on rank 0 and 0.25 on rank {N - 1}"
        self.assertEqual(said(made.stderr), [difference])
        made = subprocess.run([MPIEXEC, "-n", str(N), "--oversubscribe", "sh", "-c", script, "sh", UMTET_MPI, "evolve", *[a for a in BALL if a != "--no-report"], "--t", "0:1:1", "-o", str(self.folder / "steps")],
                              capture_output=True, text=True, timeout=PATIENT)
        self.assertEqual(made.returncode, 2, made.stderr)
        self.assertEqual(said(made.stderr), [difference])
        files["last"].unlink()
        made = subprocess.run([MPIEXEC, "-n", str(N), "--oversubscribe", "sh", "-c", script, "sh", UMTET_MPI, "mesh", *BALL, "-o", str(self.case)],
                              capture_output=True, text=True, timeout=PATIENT)
        self.assertEqual(made.returncode, 7, made.stderr)
        self.assertEqual(len(said(made.stderr)), 1, made.stderr)

    def test_memory_that_one_process_does_not_have_ends_all(self):
        # Addresses that MPI would need, and data that end in the mesh.
        for limit in ("ulimit -v 200000", "ulimit -v 300000", "ulimit -v 380000", "ulimit -d 60000"):
            with self.subTest(limit):
                made = self.run_with(LONG, limit)
                self.assertEqual(made.returncode, 9, made.stderr)
                self.assertEqual(len(said(made.stderr)), 1, made.stderr)

    def test_a_rank_that_throws_ends_all_with_its_reason(self):
        calls = [(["file", str(self.folder / "file")], 9, "out of memory in mesh")]
        if N > 1:
            calls.append((["window"], 1, "psi throws beside an open window"))
        for call, code, reason in calls:
            with self.subTest(call[0]):
                made = subprocess.run([MPIEXEC, "-n", str(N), "--oversubscribe", THROWING_RANK, *call], capture_output=True, text=True,
                                      timeout=PATIENT)
                self.assertEqual(made.returncode, code, made.stderr)
                self.assertEqual(len(said(made.stderr)), 1, made.stderr)
                self.assertIn(reason, made.stderr)

    def test_max_memory_is_of_each_process(self):
        # About a million tets take some 500 MB in one process.
        arguments = [*BALL, "--h", ".035"]
        made = self.run_with([*arguments, "--max-memory", ".05"])
        self.assertEqual(made.returncode, 9, made.stderr)
        self.assertEqual(len(said(made.stderr)), 1, made.stderr)
        needs = .9
        made = self.run_with([*arguments, "--max-memory", str(needs / N + .1)])
        self.assertEqual(made.returncode, 0, made.stderr)

    def test_more_processes_than_blocks(self):
        # A lattice of four cells along each axis, one block or a few.
        made = self.run_with([*BALL, "--h", ".6", "--export", "pvtu,pmsh,xdmf"], n=N + 8)
        self.assertIn(made.returncode, (0, 6), made.stderr)  # so coarse a ball may be off psi = 0
        names = {f.name for f in (self.case / "4-export").iterdir()}
        self.assertTrue({"mesh.pvtu", "mesh_part_1.msh", "mesh.h5"} <= names, names)
        listed = (self.case / "4-export/mesh.pvtu").read_text().count("<Piece ")
        self.assertEqual(listed, len([n for n in names if n.startswith("mesh_part_")]))
        self.assertLess(listed, N + 8)


if __name__ == "__main__":
    os.environ.setdefault("OMPI_ALLOW_RUN_AS_ROOT", "1")
    os.environ.setdefault("OMPI_ALLOW_RUN_AS_ROOT_CONFIRM", "1")
    unittest.main(argv=sys.argv[:1])
