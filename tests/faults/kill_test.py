"""kill -9, SIGINT and SIGTERM at any time: the same command ends at the bytes of an undisturbed run.

UMTET_KILLS=n tries n random times (default 6; 200 with UMTET_SLOW=1), UMTET_BURSTS=n so many signals at once.
"""
import fcntl
import json
import os
import pathlib
import random
import signal
import subprocess
import time
import unittest

from support import PATIENT, PROGRAM, SLOW, Folder, ellipsoid, promised, run, wait_until, write_ply

KILLS = int(os.environ.get("UMTET_KILLS", "200" if SLOW else "6"))
BURSTS = int(os.environ.get("UMTET_BURSTS", "300" if SLOW else "20"))


class Kill(unittest.TestCase):
    def setUp(self):
        self.scope = Folder()
        self.folder = self.scope.__enter__()
        self.addCleanup(self.scope.__exit__)
        self.cloud = write_ply(self.folder / "egg.ply", ellipsoid(600))

    def arguments(self, case, tets):
        return ["run", self.cloud, "-o", case, "--tets", str(tets), "--progress", "none"]

    def stopped(self, case, tets, with_signal, delay):
        process = subprocess.Popen([PROGRAM, *map(str, self.arguments(case, tets))], stdin=subprocess.DEVNULL,
                                   stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
        time.sleep(delay)
        process.send_signal(with_signal)
        return process.wait(timeout=PATIENT)

    def test_reruns_end_at_the_bytes_of_an_undisturbed_run(self):
        random.seed(1)
        expected, seconds = {}, {}
        for tets in (3000, 2000):
            case = self.folder / f"plain_{tets}"
            self.assertEqual(run(*self.arguments(case, tets)).returncode, 0)
            expected[tets] = promised(case)
            # How long a run takes on this machine, as it is now; the first one also loads the program.
            start = time.monotonic()
            self.assertEqual(run(*self.arguments(self.folder / f"timed_{tets}", tets)).returncode, 0)
            seconds[tets] = time.monotonic() - start
        codes = {}
        for k in range(KILLS):
            how = (signal.SIGKILL, signal.SIGKILL, signal.SIGKILL, signal.SIGTERM, signal.SIGINT)[k % 5]
            # Half of the cases have a finished mesh that is being replaced.
            case, tets = self.folder / f"case_{k}", 3000
            if k % 2:
                self.assertEqual(run(*self.arguments(case, 2000)).returncode, 0)
            start = time.monotonic()
            code = self.stopped(case, tets, how, random.uniform(0, 1.1 * seconds[tets]))
            if code == 0:  # the machine may have become faster
                seconds[tets] = min(seconds[tets], time.monotonic() - start)
            self.assertIn(code, (0, -how, 128 + how))
            codes[code] = codes.get(code, 0) + 1
            left = promised(case) if case.exists() else {}
            for name, content in left.items():
                allowed = [expected[tets].get(name)] + ([expected[2000].get(name)] if k % 2 else [])
                self.assertTrue(content in allowed, f"{name} is damaged after {code}")
            again = run(*self.arguments(case, tets))
            self.assertEqual(again.returncode, 0, again.stderr)
            self.assertTrue(promised(case) == expected[tets], f"run {k}, stopped with {code}: other bytes")
            self.assertFalse((case / ".next").exists())
            self.assertEqual([f for f in case.rglob(".tmp-*")], [], "temporary files are left")
        print(f"{KILLS} of {KILLS} reruns are byte-equal; exit codes of the stopped runs: {codes}")
        self.assertGreater(sum(n for code, n in codes.items() if code != 0), KILLS // 6)

    def test_a_second_signal_ends_at_once_and_json_has_its_document(self):
        for k in range(3):
            process = self.begun(f"json_{k}")
            process.stderr.readline()  # a stage is done
            process.send_signal(signal.SIGINT)
            process.send_signal(signal.SIGTERM)
            self.check_answer(process, (130, 143))

    def begun(self, case, *more, tets=200000):
        return subprocess.Popen([PROGRAM, *map(str, self.arguments(self.folder / case, tets)), "--json", *more],
                                stdin=subprocess.DEVNULL, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True)

    def check_answer(self, process, codes):
        """One whole document on stdout, of the failure or success that the exit code says."""
        out, said = process.communicate(timeout=PATIENT)
        self.assertIn(process.returncode, codes, said)
        try:
            document = json.loads(out)
        except ValueError:
            self.fail(f"exit {process.returncode}: no document: {out!r}\n{said}")
        self.assertEqual((document["command"], document["exit_code"]), ("run", process.returncode), out)
        if process.returncode != 0:
            self.assertIn("the case can be resumed", document["error"])
        return process.returncode

    def test_signals_and_the_time_limit_at_once_give_one_document(self):
        """At the end of the run too, where the program itself is about to answer."""
        random.seed(3)
        start = time.monotonic()
        self.assertEqual(run(*self.arguments(self.folder / "timed", 1500)).returncode, 0)
        seconds = time.monotonic() - start
        codes = {}
        for k in range(BURSTS):
            at = random.uniform(0, 1.2 * seconds)
            start = time.monotonic()
            process = self.begun(f"burst_{k}", "--timeout", f"{max(.001, at):.6f}", tets=1500)
            process.stderr.readline()  # handlers are there
            time.sleep(max(0, start + at - time.monotonic()))
            for _ in range(random.randint(1, 5)):
                process.send_signal(random.choice((signal.SIGINT, signal.SIGTERM)))
                time.sleep(random.choice((0, 0, 1e-5, 1e-4, 1e-3)))
            code = self.check_answer(process, (0, 9, 130, 143))
            codes[code] = codes.get(code, 0) + 1
        print(f"{BURSTS} of {BURSTS} answers are one document; exit codes: {codes}")

    def test_signals_while_an_answer_waits_for_its_reader_change_nothing_in_it(self):
        """A full pipe holds the answer back for a moment, that of a signal and that of the program."""
        for k in range(6):
            process = self.begun(f"slow_reader_{k}", tets=200000 if k % 2 else 1500)
            fcntl.fcntl(process.stdout, fcntl.F_SETPIPE_SZ, 4096)
            # White space before a document is part of it; hardly a word of the answer has room beside this.
            with open(f"/proc/{process.pid}/fd/1", "w") as pipe:
                pipe.write(4000 * " ")
            process.stderr.readline()
            if k % 2 == 0:
                waits_in = pathlib.Path(f"/proc/{process.pid}/wchan")  # a function of the kernel
                self.assertTrue(wait_until(lambda: "pipe" in waits_in.read_text()), "no answer is written")
            for n in range(8):
                process.send_signal((signal.SIGINT, signal.SIGTERM)[n % 2])
                time.sleep(.01)
            self.check_answer(process, (130, 143) if k % 2 else (0,))


if __name__ == "__main__":
    unittest.main()
