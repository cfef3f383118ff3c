"""umtet batch: many scans, one table; whatever becomes of one, the others are made."""
import csv
import json
import os
import pathlib
import signal
import subprocess
import unittest

from support import PATIENT, PROGRAM, SLOW, Folder, ellipsoid, run, wait_until, write_ply


def bad_scans(folder):
    """Name, file and exit codes that are right, of clouds that can have no mesh."""
    good = ellipsoid(300)
    flat = [f"{i % 20} {i // 20} 0 0 0 1" for i in range(400)]
    (folder / "text.ply").write_text("this is no cloud\n")
    (folder / "empty.ply").write_text("")
    (folder / "folder.ply").mkdir()
    write_ply(folder / "none_left.ply", [])
    write_ply(folder / "cut.ply", good[:100], count=300)
    write_ply(folder / "huge_count.ply", good, count=10 ** 15)
    write_ply(folder / "three_points.ply", good[:3])
    write_ply(folder / "not_numbers.ply", ["nan nan nan 0 0 1"] * 300)
    write_ply(folder / "one_place.ply", ["1 2 3 0 0 1"] * 300)
    write_ply(folder / "flat.ply", flat)
    write_ply(folder / "on_a_line.ply", [f"{i} 0 0 0 1 0" for i in range(300)])
    write_ply(folder / "words.ply", ["a b c d e f"] * 300)
    (folder / "header.ply").write_bytes(b"ply\nformat ascii 1.0\nelement vertex 3\n")
    (folder / "unknown.las").write_bytes(b"LASF" + bytes(400))
    return ["text.ply", "empty.ply", "folder.ply", "none_left.ply", "cut.ply", "huge_count.ply", "three_points.ply",
            "not_numbers.ply", "one_place.ply", "flat.ply", "on_a_line.ply", "words.ply", "header.ply", "unknown.las",
            "missing.ply"]


def is_alive(pid):
    try:
        return pathlib.Path(f"/proc/{pid}/stat").read_text().rsplit(")", 1)[1].split()[0] != "Z"
    except OSError:
        return False


def table(folder):
    with open(folder / "batch.csv", newline="", encoding="utf-8") as file:
        return list(csv.DictReader(file))


class Batch(unittest.TestCase):
    def scans(self, folder, n_good, n_bad):
        """A list of n_good eggs, each another, with bad scans between them."""
        (folder / "scans").mkdir()
        bad = bad_scans(folder / "scans")[:n_bad]
        good = []
        for k in range(n_good):
            name = f"egg {k}.ply"
            write_ply(folder / "scans" / name, ellipsoid(250 + k, (1, .7 + .3 * k / n_good, .6)))
            good.append(name)
        mixed, step = list(good), max(1, n_good // max(1, n_bad))
        for k, name in enumerate(bad):
            mixed.insert(k * (step + 1), name)
        (folder / "list").write_text("# scans\n" + "".join(f"scans/{n}\n" for n in mixed))
        return mixed, bad

    def check_rows(self, folder, names, bad):
        rows = table(folder / "out")
        self.assertEqual([os.path.basename(r["scan"]) for r in rows], names)
        for row in rows:
            if os.path.basename(row["scan"]) in bad:
                self.assertIn(row["exit_code"], ("3", "4", "5", "7"), row)
                self.assertNotIn(row["verdict"], ("pass", "crash", "waiting"), row)
                self.assertTrue(row["reason"], row)
            else:
                self.assertEqual((row["verdict"], row["exit_code"], row["reason"]), ("pass", "0", ""), row)
                self.assertGreater(float(row["min_quality"]), .5)
                certificate = folder / "out" / row["case"] / "certificate.json"
                self.assertEqual(json.loads(certificate.read_text())["verdict"], "pass")
        return rows

    def test_bad_scans_are_rows_and_the_others_are_made(self):
        n_good, n_bad = (85, 15) if SLOW else (4, 15)
        with Folder() as folder:
            names, bad = self.scans(folder, n_good, n_bad)
            first = run("batch", "list", "-o", "out", "--jobs", 2, "--tets", 1500, cwd=folder, timeout=900)
            self.assertEqual(first.returncode, 6, first.stderr)
            self.assertIn(f"{n_good} of {n_good + n_bad} scans pass", first.stdout)
            rows = self.check_rows(folder, names, bad)
            page = (folder / "out" / "batch.html").read_text()
            self.assertEqual(page.count("<tr>"), 1 + len(names))
            self.assertIn('href="egg%200/"', page)
            self.assertNotIn("<script", page)
            # Again: nothing is made, refused scans are not even tried, and the table is the same.
            again = run("batch", "list", "-o", "out", "--jobs", 2, "--tets", 1500, "--resume", "--json", cwd=folder)
            self.assertEqual(again.returncode, 6, again.stderr)
            still = table(folder / "out")
            for row in (*rows, *still):
                if row["case"] in ("missing", "folder"):  # tried again: there may be a file now
                    row["seconds"] = row["peak_memory_MB"] = ""
            self.assertEqual(still, rows)
            self.assertEqual(len(json.loads(again.stdout)["scans"]), len(names))
            logs = list((folder / "out" / "logs").glob("*.json"))
            made = [f.stem for f in logs if json.loads(f.read_text()).get("stages_run")]
            self.assertEqual(made, [])

    def test_a_child_that_dies_is_a_row(self):
        with Folder() as folder:
            names, _ = self.scans(folder, 2, 0)
            write_ply(folder / "scans" / names[0], ellipsoid(3000))
            batch = subprocess.Popen([PROGRAM, "batch", "list", "-o", "out", "--tets", "200000", "--set",
                                      "mesh.mode=paper", "-q"], cwd=folder, stdout=subprocess.PIPE, stderr=subprocess.PIPE)
            children = pathlib.Path(f"/proc/{batch.pid}/task/{batch.pid}/children")
            child = int(wait_until(children.read_text).split()[0])
            own, its = (pathlib.Path(f"/proc/{pid}/cmdline") for pid in (batch.pid, child))
            wait_until(lambda: its.read_bytes() != own.read_bytes())  # it has become the program
            os.kill(child, signal.SIGKILL)
            wait_until(lambda: (folder / "out/batch.csv").exists() and
                       table(folder / "out")[0]["verdict"] != "waiting")
            batch.send_signal(signal.SIGTERM)
            _, said = batch.communicate(timeout=PATIENT)
            self.assertEqual(batch.returncode, 143, said)
            rows = table(folder / "out")
            self.assertEqual(rows[0]["verdict"], "crash")
            self.assertIn("signal 9", rows[0]["reason"])
            self.assertIn(rows[1]["verdict"], ("stopped", "waiting"))
            # Stopped scans are made by the same command; nobody holds their cases.
            self.assertEqual(run("batch", "list", "-o", "out", "--tets", 1500, cwd=folder).returncode, 0)

    def test_children_end_with_a_batch_that_is_killed(self):
        with Folder() as folder:
            self.scans(folder, 1, 0)
            batch = subprocess.Popen([PROGRAM, "batch", "list", "-o", "out", "--tets", "200000", "--set",
                                      "mesh.mode=paper", "-q"], cwd=folder, stderr=subprocess.DEVNULL)
            lock = folder / "out" / "egg 0" / ".lock"
            child = int(wait_until(lambda: lock.exists() and lock.read_text()))
            batch.kill()
            batch.wait()
            self.assertTrue(wait_until(lambda: not is_alive(child)), "the child goes on")

    def test_time_and_memory_are_limits_of_a_scan(self):
        with Folder() as folder:
            self.scans(folder, 1, 0)
            slow = run("batch", "list", "-o", "out", "--tets", 300000, "--set", "mesh.mode=paper", "--timeout", .5,
                       cwd=folder)
            self.assertEqual(slow.returncode, 6, slow.stderr)
            row = table(folder / "out")[0]
            self.assertEqual((row["verdict"], row["exit_code"]), ("limit", "9"))
            self.assertIn("out of time in ", row["reason"])
            self.assertLess(float(row["seconds"]), 60)  # without a limit it takes minutes on any machine
            run("batch", "list", "-o", "out", "--tets", 300000, "--max-memory", .01, cwd=folder)
            row = table(folder / "out")[0]
            self.assertEqual((row["verdict"], row["exit_code"]), ("limit", "9"))
            self.assertIn("memory", row["reason"])

    def test_calls_that_cannot_begin_are_usage(self):
        with Folder() as folder:
            self.scans(folder, 1, 0)
            (folder / "nothing").write_text("# none\n")
            (folder / "mine").mkdir()
            (folder / "mine" / "batch.csv").write_text("precious")
            self.assertEqual(run("batch", "list", cwd=folder).returncode, 2)
            self.assertEqual(run("batch", "nothing", "-o", "out", cwd=folder).returncode, 2)
            self.assertEqual(run("batch", "absent", "-o", "out", cwd=folder).returncode, 7)
            (folder / "cloud.xyz").write_text("0 0 1\n0 1 0\n")
            no_list = run("batch", "cloud.xyz", "-o", "out", cwd=folder)
            self.assertEqual(no_list.returncode, 2)
            self.assertIn("none of the 2 files", no_list.stderr)
            # Up to its NUL the line is the path of a folder, which is there.
            (folder / "cloud.ply").write_bytes(b"ply\n\0\x3f\x01\n")
            self.assertEqual(run("batch", "cloud.ply", "-o", "out", cwd=folder).returncode, 2)
            self.assertFalse((folder / "out").exists())
            self.assertEqual(run("batch", "list", "-o", "mine", cwd=folder).returncode, 2)
            self.assertEqual((folder / "mine" / "batch.csv").read_text(), "precious")
            (folder / "case").mkdir()
            (folder / "case" / "case.toml").write_text("")
            self.assertEqual(run("batch", "list", "-o", "case", cwd=folder).returncode, 2)
            self.assertEqual(run("batch", "list", "-o", "out", "--set", "mesh.implicit=x", cwd=folder).returncode, 2)


if __name__ == "__main__":
    unittest.main()
