"""kill -9 of one process of `mpirun -n N umtet_mpi`, at places all over a run: all end at once, what is in the case is whole, and the same command ends at the bytes of an undisturbed run.

usage: kills_test.py UMTET_MPI MPIEXEC SHIM N

Rank 0 is killed when a file is to take its place in the case, which it does from the first stage to the last, the others in calls of MPI, from the first to the last. So places are the same whenever this runs. UMTET_KILLS=n tries n of them (default 20).
"""
import os
import pathlib
import shutil
import subprocess
import sys
import tempfile
import time
import unittest

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parents[1] / "faults"))
from support import ellipsoid, promised, write_ply  # noqa: E402

UMTET_MPI, MPIEXEC, SHIM, N = sys.argv[1], sys.argv[2], sys.argv[3], int(sys.argv[4])
KILLS = int(os.environ.get("UMTET_KILLS", "20"))
PATIENT = 120  # seconds, for what takes some: only what hangs is found
# mpirun sends the others SIGTERM, and SIGKILL a second later. The rest is for a busy machine.
MOST_SECONDS = 5


class Kills(unittest.TestCase):
    def setUp(self):
        self.folder = pathlib.Path(tempfile.mkdtemp(prefix="umtet_kills_"))
        self.addCleanup(shutil.rmtree, self.folder, ignore_errors=True)
        # Samples that are dense enough for a band, which ranks fit together.
        self.cloud = write_ply(self.folder / "egg.ply", ellipsoid(4000))

    def run_ranks(self, case, h, **kill):
        """@param kill  variables of kill_shim.c. @return the finished process, and when it ended"""
        hook = ["-x", f"LD_PRELOAD={SHIM}", "-x", f"UMTET_KILL_LOG={self.folder / 'steps'}"]
        for name, value in kill.items():
            hook += ["-x", f"UMTET_KILL_{name}={value}"]
        made = subprocess.run([MPIEXEC, "-n", str(N), "--oversubscribe", *hook, UMTET_MPI, "run", str(self.cloud), "-o", str(case),
                               "--set", "reconstruct.spacing=.03", "--h", h, "--export", "pvtu", "--threads", "1", "--progress", "none"],
                              stdin=subprocess.DEVNULL, capture_output=True, text=True, timeout=PATIENT)
        return made, time.time()

    def last_step(self, rank):
        """How many steps a rank has made, the name of the last, and when that was."""
        n, name, at = (self.folder / f"steps.{rank}").read_text().split()
        return int(n), name, float(at)

    def made(self, name, h):
        """What an undisturbed run leaves."""
        done, _ = self.run_ranks(self.folder / name, h)
        self.assertEqual(done.returncode, 0, done.stderr)
        return promised(self.folder / name)

    def begun(self, name, is_finished):
        """A new case, or one with a mesh that is to be replaced."""
        case = self.folder / name
        if is_finished:
            shutil.copytree(self.folder / "former", case)
        return case

    def n_steps(self, is_finished, **kind):
        """Of each rank."""
        case = self.begun("counted", is_finished)
        self.assertEqual(self.run_ranks(case, ".12", **kind)[0].returncode, 0)
        shutil.rmtree(case)
        return [self.last_step(rank)[0] for rank in range(N)]

    def places(self):
        """A rank, a kind of steps and the number of one of them, and whether the case was finished before."""
        n_of = {(finished, of_0): self.n_steps(finished, **({"STEP": "rename"} if of_0 else {}))
                for finished in (False, True) for of_0 in (False, True)}
        quarter = max(1, (KILLS - 1) // 4)
        for k in range(KILLS):
            of_0, finished = k % 2 == 0 or N == 1, k // 2 % 2 == 1
            rank = 0 if of_0 else 1 + k // 4 % (N - 1)
            n = n_of[finished, of_0][rank]
            yield {"RANK": rank, "AT": 1 + (n - 1) * (k // 4) // quarter, **({"STEP": "rename"} if of_0 else {})}, finished

    def require_whole(self, left, former, new):
        """Each file is of one of two runs; a case with its certificate is one of them."""
        for name, content in left.items():
            self.assertTrue(content in (former.get(name), new.get(name)), f"{name} is damaged")
        if "certificate.json" not in left:
            return None
        for files in (former, new):
            if left["certificate.json"] == files.get("certificate.json"):
                self.assertEqual([n for n in files if not n.startswith("4-") and left.get(n) != files[n]], [])
                return files
        self.fail("a certificate of neither")

    def test_reruns_end_at_the_bytes_of_an_undisturbed_run(self):
        plain, former = self.made("plain", ".12"), self.made("former", ".17")
        seconds, names, n_untouched, n_equal = [], set(), 0, 0
        for k, (place, is_finished) in enumerate(self.places()):
            case = self.begun(f"case_{k}", is_finished)
            with self.subTest(**place, is_finished=is_finished):
                killed, end = self.run_ranks(case, ".12", **place)
                n, name, at = self.last_step(place["RANK"])
                self.assertEqual(n, place["AT"], "it was not killed there")
                names.add(name)
                self.assertNotEqual(killed.returncode, 0, killed.stderr)
                self.assertLessEqual(len([line for line in killed.stderr.splitlines() if line.startswith("umtet: ")]), 1, killed.stderr)
                seconds.append(end - at)
                self.assertLess(seconds[-1], MOST_SECONDS)
                found = self.require_whole(promised(case) if case.exists() else {}, former if is_finished else {}, plain)
                n_untouched += found is former
                again, _ = self.run_ranks(case, ".12")
                self.assertEqual(again.returncode, 0, again.stderr)
                self.assertTrue(promised(case) == plain, "other bytes")
                self.assertEqual([str(f) for f in case.rglob(".tmp-*")] + [str(f) for f in case.glob(".next")], [])
                n_equal += 1
            shutil.rmtree(case)
        print(f"{n_equal} of {KILLS} reruns are byte-equal. Killed in {', '.join(sorted(names))}; all have ended {min(seconds):.2f} to "
              f"{max(seconds):.2f} s later; {n_untouched} finished cases were as they had been")


if __name__ == "__main__":
    os.environ.setdefault("OMPI_ALLOW_RUN_AS_ROOT", "1")
    os.environ.setdefault("OMPI_ALLOW_RUN_AS_ROOT_CONFIRM", "1")
    unittest.main(argv=sys.argv[:1])
