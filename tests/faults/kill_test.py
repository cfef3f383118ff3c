"""kill -9, SIGINT and SIGTERM at any time: the same command ends at the bytes of an undisturbed run.

UMTET_KILLS=n tries n random times (default 6; 200 with UMTET_SLOW=1).
"""
import json
import os
import random
import signal
import subprocess
import time
import unittest

from support import PROGRAM, SLOW, Folder, ellipsoid, promised, run, write_ply

KILLS = int(os.environ.get("UMTET_KILLS", "200" if SLOW else "6"))


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
        return process.wait(timeout=60)

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
            code = self.stopped(case, tets, how, random.uniform(0, 1.1 * seconds[tets]))
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
        self.assertGreater(sum(n for code, n in codes.items() if code != 0), KILLS // 3)

    def test_a_second_signal_ends_at_once_and_json_has_its_document(self):
        for k in range(3):
            process = subprocess.Popen([PROGRAM, *map(str, self.arguments(self.folder / f"json_{k}", 200000)), "--json"],
                                       stdin=subprocess.DEVNULL, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True)
            process.stderr.readline()  # a stage is done
            process.send_signal(signal.SIGINT)
            process.send_signal(signal.SIGTERM)
            out, said = process.communicate(timeout=60)
            self.assertIn(process.returncode, (130, 143), said)
            document = json.loads(out)
            self.assertEqual((document["command"], document["exit_code"]), ("run", process.returncode), out)
            self.assertIn("the case can be resumed", document["error"])


if __name__ == "__main__":
    unittest.main()
