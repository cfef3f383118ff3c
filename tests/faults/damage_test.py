"""Artefacts that are cut, flipped, absurd or of another version; odd paths, folders and environments."""
import json
import re
import shutil
import subprocess
import threading
import unittest

from support import PATIENT, PROGRAM, SLOW, Folder, ellipsoid, promised, run, wait_until, write_ply

ARTEFACTS = ("1-cloud/cloud.ply", "1-cloud/record.json", "2-level-set/level_set.vti", "2-level-set/record.json",
             "3-mesh/mesh.vtu", "3-mesh/omega_h.vtu", "3-mesh/projected.vtu", "3-mesh/quality.csv",
             "3-mesh/record.json", "case.toml", "certificate.json")


def sections(name, content):
    """Where a file may be cut: before and behind every line of a header, tag, array, key, section or table.

    Whatever the format, also in the middle of the longest of these, and before the last byte but one."""
    pattern = {"ply": rb"(?<=\n)(?=[a-z]+ )|(?<=end_header\n)", "vti": rb"(?=<)|(?<=>)", "vtu": rb"(?=<)|(?<=>)",
               "csv": rb"(?<=\n)(?=[a-z])|(?<=,)(?=[a-z])", "json": rb"(?<=\n)(?= *\")", "toml": rb"(?<=\n)"}
    cuts = sorted({m.start() for m in re.finditer(pattern[name.rsplit(".", 1)[1]], content)} | {0, len(content) - 2})
    longest = max(range(len(cuts) - 1), key=lambda k: cuts[k + 1] - cuts[k])
    return sorted({*cuts, (cuts[longest] + cuts[longest + 1]) // 2} - {len(content)})


class Damage(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.scope = Folder()
        cls.folder = cls.scope.__enter__()
        cls.addClassCleanup(cls.scope.__exit__)
        cls.cloud = write_ply(cls.folder / "egg.ply", ellipsoid(250))
        cls.plain = cls.folder / "plain"
        made = cls.call(cls.plain)
        if made.returncode != 0:
            raise RuntimeError(made.stderr)
        cls.expected = promised(cls.plain)

    @classmethod
    def call(cls, case, *more, **options):
        return run("run", cls.cloud, "-o", case, "--tets", 700, "--progress", "none", *more, **options)

    def mended(self, name, content, what):
        """--strict refuses with exit 8; the same command without it ends at the bytes that were there."""
        case = self.folder / "damaged"
        shutil.rmtree(case, ignore_errors=True)
        shutil.copytree(self.plain, case)
        (case / name).write_bytes(content)
        strict = self.call(case, "--strict")
        self.assertEqual(strict.returncode, 8, f"{name} {what}: {strict.stderr}")
        self.assertIn(str(case / name), strict.stderr)
        again = self.call(case)
        self.assertEqual(again.returncode, 0, f"{name} {what}: {again.stderr}")
        self.assertIn("making it again", again.stderr, f"{name} {what}")
        self.assertTrue(promised(case) == self.expected, f"{name} {what}")
        if name == "case.toml":
            self.assertTrue((case / name).read_bytes() == (self.plain / name).read_bytes())

    def test_cut_and_flipped_artefacts_are_noticed_and_made_again(self):
        n_cuts = 0
        for k, name in enumerate(ARTEFACTS):
            good = (self.plain / name).read_bytes()
            cuts = sections(name, good)
            for at in cuts if SLOW else cuts[k * 7919 % len(cuts):][:k % 2]:
                n_cuts += 1
                with self.subTest(name=name, cut=at):
                    self.mended(name, good[:at], f"cut at {at}")
            for at in range(0, len(good), max(1, len(good) // 12)) if SLOW else [(k * 7919 + 13) % len(good)][k % 2:]:
                flipped = good[:at] + bytes([good[at] ^ 1 << k % 7]) + good[at + 1:]
                with self.subTest(name=name, flipped=at):
                    self.mended(name, flipped, f"flipped at {at}")
        print(f"{n_cuts} cuts in {len(ARTEFACTS)} artefacts were noticed and made again")

    def test_what_a_killed_run_has_begun_is_removed_though_all_is_done(self):
        case = self.folder / "begun"
        shutil.copytree(self.plain, case)
        for name in ("case.toml", "certificate.json", "report.html"):
            (case / f".tmp-1-{name}").write_text("begun")
        (case / ".next/3-mesh").mkdir(parents=True)  # killed behind the last move out of it
        self.assertEqual(self.call(case).returncode, 0)
        self.assertEqual(list(case.rglob(".tmp-*")), [])
        self.assertFalse((case / ".next").exists())

    def test_a_run_killed_while_it_moves_a_stage_leaves_nothing_behind_the_next_one(self):
        case = self.folder / "moving"
        shutil.copytree(self.plain, case)
        (case / ".next/3-mesh").mkdir(parents=True)
        (case / "3-mesh/record.json").rename(case / ".next/3-mesh/record.json")
        self.assertEqual(self.call(case).returncode, 0)
        self.assertFalse((case / ".next").exists())
        self.assertTrue(promised(case) == self.expected)

    def test_records_of_another_schema_are_made_again(self):
        case = self.folder / "newer"
        shutil.copytree(self.plain, case)
        record = case / "3-mesh/record.json"
        record.write_text(record.read_text().replace('"schema": 2', '"schema": 999'))
        again = self.call(case)
        self.assertEqual(again.returncode, 0, again.stderr)
        self.assertTrue(promised(case) == self.expected)

    def test_paths_may_have_any_characters(self):
        for name in ("with spaces", "Größe-网格", "line\nbreak", "-dash", "quote'\"$HOME;&"):
            with self.subTest(name=name):
                folder = self.folder / f"odd {name}"
                folder.mkdir()
                cloud = folder / f"{name}.ply"
                shutil.copy(self.cloud, cloud)
                made = run("run", cloud, "-o", folder / name, "--tets", 700, "--json")
                self.assertEqual(made.returncode, 0, made.stderr)
                self.assertEqual(json.loads(made.stdout)["certificate"]["verdict"], "pass")
                mesh = (folder / name / "3-mesh/mesh.vtu").read_bytes()
                self.assertTrue(mesh == self.expected["3-mesh/mesh.vtu"])

    def test_the_language_of_the_system_changes_no_byte(self):
        locales = self.folder / "locales"
        locales.mkdir()
        made = subprocess.run(["localedef", "-i", "de_DE", "-f", "UTF-8", locales / "de_DE.UTF-8"], capture_output=True)
        if made.returncode != 0:
            self.skipTest("needs Debian's locales, for numbers with a comma")
        german = self.call(self.folder / "german", env={"LC_ALL": "de_DE.UTF-8", "LOCPATH": str(locales)})
        self.assertEqual(german.returncode, 0, german.stderr)
        self.assertTrue(promised(self.folder / "german") == self.expected)

    def test_a_closed_stdout_is_file_trouble_and_the_mesh_is_there(self):
        case = self.folder / "closed"
        command = '"$0" "$@" >&-'
        closed = subprocess.run(["/bin/sh", "-c", command, PROGRAM, "run", self.cloud, "-o", case, "--tets", "700"],
                                stderr=subprocess.PIPE, text=True)
        self.assertEqual(closed.returncode, 7, closed.stderr)
        self.assertIn("stdout", closed.stderr)
        self.assertTrue(promised(case) == self.expected)

    def test_folders_that_cannot_be_written_are_file_trouble(self):
        for place in ("/proc/umtet", "/dev/null/case", str(self.cloud / "case")):
            refused = self.call(place)
            self.assertEqual(refused.returncode, 7, refused.stderr)
            self.assertIn(place.rsplit("/", 1)[0], refused.stderr)

    def test_a_folder_that_goes_away_is_no_success(self):
        """What was opened is gone from under the run: no record is left that claims what is not there."""
        case = self.folder / "gone"
        process = subprocess.Popen([PROGRAM, "run", self.cloud, "-o", case, "--tets", "200000", "--set",
                                    "mesh.mode=paper", "-q"], stdout=subprocess.DEVNULL, stderr=subprocess.PIPE, text=True)
        level_set = case / "2-level-set/record.json"
        wait_until(lambda: level_set.exists() or process.poll() is not None)
        shutil.rmtree(case, ignore_errors=True)
        process.terminate()
        _, said = process.communicate(timeout=PATIENT)
        self.assertIn(process.returncode, (7, 8, 143), said)  # 8: a stage it had finished is there no more
        self.assertFalse((case / "certificate.json").exists())

    def test_one_of_two_runs_on_a_case_is_refused(self):
        case = self.folder / "shared"
        calls = [subprocess.Popen([PROGRAM, "run", self.cloud, "-o", case, "--tets", "700", "--progress", "none"],
                                  stdout=subprocess.DEVNULL, stderr=subprocess.PIPE, text=True) for _ in range(2)]
        ends = [(c.communicate(timeout=PATIENT)[1], c.returncode) for c in calls]
        self.assertIn(0, [code for _, code in ends], ends)
        for said, code in ends:
            if code != 0:
                self.assertEqual(code, 7, said)
                self.assertIn("another umtet", said)
        self.assertTrue(promised(case) == self.expected)

    def test_input_that_changes_during_a_run_is_never_taken_for_what_was_read(self):
        """Whatever was read, the next run sees the file of then, and ends at its mesh."""
        cloud = self.folder / "changing.ply"
        shutil.copy(self.cloud, cloud)
        other = write_ply(self.folder / "other.ply", ellipsoid(250, (1, .9, .7)))
        case, fresh = self.folder / "changed", self.folder / "fresh"
        stop = threading.Event()

        def change():
            k = 0
            while not stop.is_set():
                shutil.copy((self.cloud, other)[k % 2], cloud)
                k += 1

        changer = threading.Thread(target=change)
        changer.start()
        first = run("run", cloud, "-o", case, "--tets", 700)
        stop.set()
        changer.join()
        self.assertIn(first.returncode, (0, 3, 7), first.stderr)
        shutil.copy(other, cloud)
        self.assertEqual(run("run", cloud, "-o", case, "--tets", 700).returncode, 0)
        self.assertEqual(run("run", cloud, "-o", fresh, "--tets", 700).returncode, 0)
        self.assertTrue((case / "3-mesh/mesh.vtu").read_bytes() == (fresh / "3-mesh/mesh.vtu").read_bytes())


if __name__ == "__main__":
    unittest.main()
