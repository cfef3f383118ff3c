"""The n-th allocation fails, or the n-th open, write, fsync, rename or close of a file of the case, for n = 1, 2, 3 ...

A run that fails says so with exit 7 (files; the message names the file) or 9 (memory; it names the stage). What it
leaves under final names is what an undisturbed run has there, and the same command without a fault ends at the same
bytes. UMTET_SLOW=1 tries every n of files, and of allocations the first 200 and then one in 1.03.
"""
import unittest

from support import SHIM, SLOW, Folder, ellipsoid, promised, run, write_ply

FILE_CALLS = ("open", "write", "fsync", "rename", "close")
STAGES = ("start", "cloud", "level-set", "mesh", "certificate")


class Injection(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.scope = Folder()
        cls.folder = cls.scope.__enter__()
        cls.cloud = write_ply(cls.folder / "egg.ply", ellipsoid(250))
        cls.plain = cls.folder / "plain"
        undisturbed = cls.call(cls.plain)
        if undisturbed.returncode != 0:
            raise RuntimeError(undisturbed.stderr)
        cls.expected = promised(cls.plain)

    @classmethod
    def tearDownClass(cls):
        cls.scope.__exit__()

    @classmethod
    def call(cls, case, env=None):
        # One thread: the n-th call is then the same one every time.
        return run("run", cls.cloud, "-o", case, "--tets", 700, "--threads", 1, "--progress", "none", env=env)

    def faulty(self, kind, at, case, bytes_=1, count=1):
        log = self.folder / "count"
        log.unlink(missing_ok=True)
        env = {"LD_PRELOAD": SHIM, "UMTET_FAULT": kind, "UMTET_FAULT_AT": str(at), "UMTET_FAULT_UNDER": str(case),
               "UMTET_FAULT_COUNT": str(log), "UMTET_FAULT_BYTES": str(bytes_), "UMTET_FAULT_FOR": str(count)}
        result = self.call(case, env)
        # A process that ends without destructors has no count, and has not gone past the fault.
        return result, int(log.read_text()) if log.exists() else at

    def check(self, kind, at, code, case, result):
        what = f"{kind} {at}: exit {result.returncode}: {result.stderr}"
        left = promised(case) if case.exists() else {}
        for name, content in left.items():
            self.assertTrue(content == self.expected.get(name), f"{what}\n{name} is damaged")
        if result.returncode == 0:
            self.assertEqual(left.keys(), self.expected.keys(), what)
            return
        self.assertEqual(result.returncode, code, what)
        self.assertTrue(any(word in result.stderr for word in ([str(case)] if code == 7 else STAGES)), what)

    def sweep(self, kind, code, ats, repair_every, **options):
        failed = 0
        for k, at in enumerate(ats):
            with self.subTest(kind=kind, at=at):
                case = self.folder / f"{kind}_{at}"
                result, calls = self.faulty(kind, at, case, **options)
                self.check(kind, at, code, case, result)
                failed += result.returncode != 0
                if k % repair_every == 0:
                    again = self.call(case)
                    self.assertEqual(again.returncode, 0, again.stderr)
                    self.assertTrue(promised(case) == self.expected, f"{kind} {at}: other bytes")
                if result.returncode == 0 and calls < at:
                    return failed
        return failed

    def test_files(self):
        for kind in FILE_CALLS:
            _, calls = self.faulty(kind, -1, self.folder / f"count_{kind}")
            self.assertGreater(calls, 5, f"the shim sees no {kind}")
            some = sorted({1 + k * (calls - 1) // 2 for k in range(3)})
            ats = range(1, calls + 2) if SLOW else some
            failed = self.sweep(kind, 7, ats, 1 if SLOW else 2)
            self.assertGreater(failed, 0, f"no {kind} that fails is noticed")

    def test_allocations(self):
        _, calls = self.faulty("malloc", -1, self.folder / "count_malloc")
        self.assertGreater(calls, 1000, "the shim sees no malloc")
        ats = []
        at = 1
        while at <= calls:
            ats.append(at)
            at = max(at + 1, int(at * (1.03 if at > 200 else 1))) if SLOW else 3 * at + 1
        failed = self.sweep("malloc", 9, ats, 10)
        self.assertGreater(failed, len(ats) // 2)

    def test_large_allocations(self):
        """What a machine without memory refuses first: everything of 64 KiB and more, from some point on."""
        _, calls = self.faulty("malloc", -1, self.folder / "count_large", bytes_=1 << 16)
        ats = range(1, calls + 1) if SLOW else range(1, calls + 1, max(1, calls // 5))
        self.sweep("malloc", 9, ats, 10, bytes_=1 << 16, count=10 ** 9)


if __name__ == "__main__":
    unittest.main()
