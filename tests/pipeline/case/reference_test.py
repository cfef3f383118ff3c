"""docs/reference.md names every key, column, field and parameter of the program, and docs/using.md every command: reference_test.py PROGRAM REPOSITORY."""
import json
import pathlib
import re
import subprocess
import sys
import tempfile
import unittest

PROGRAM, REPOSITORY = sys.argv.pop(1), pathlib.Path(sys.argv.pop(1)).resolve()
BALL = ["--implicit", "x^2+y^2+z^2-1", "--box=-2,-2,-2,2,2,2"]


def run(*words, code=0):
    done = subprocess.run([PROGRAM, *words], capture_output=True, text=True)
    assert done.returncode == code, done.stderr
    return done.stdout


def keys(document, free=()):
    """All keys of a document, but for those below a key of `free`."""
    if isinstance(document, list):
        return set().union(*(keys(d, free) for d in document))
    if not isinstance(document, dict):
        return set()
    return set(document).union(*(keys(d, free) for k, d in document.items() if k not in free))


class Reference(unittest.TestCase):
    def setUp(self):
        self.folder = tempfile.TemporaryDirectory()
        self.at = pathlib.Path(self.folder.name)
        self.words = set(re.findall(r"[\w.-]+", " ".join(re.findall(r"`([^`]+)`", (REPOSITORY / "docs/reference.md").read_text()))))

    def tearDown(self):
        self.folder.cleanup()

    def expect(self, found, where):
        self.assertTrue(found)
        self.assertEqual(sorted(set(found) - self.words), [], f"{where}: not in docs/reference.md")

    def test_documents_and_fields_are_named(self):
        duck, lens, cube, can = (str(self.at / name) for name in ("duck", "lens", "cube", "can"))
        calls = (["run", str(REPOSITORY / "data/clouds/duck.ply"), "-o", duck, "--h", ".12", "--order", "2"],
                 ["mesh", "--implicit", "x^2+y^2+(z/0.2)^2-1", "--box=-1.9,-1.9,-1.2,1.9,1.9,1.2", "--h", ".2", "-o", lens],
                 ["mesh", "--implicit", "max(x^2+y^2-1,abs(z)-1)", "--box=-1.9,-1.9,-1.9,1.9,1.9,1.9", "--h", ".3", "-o", can],
                 ["run", str(REPOSITORY / "tests/corpus/files/triangles_obj/cube.obj"), "-o", cube, "--h", ".08"])
        for call in calls:
            document = json.loads(run(*call, "--json"))
            self.expect(keys(document, {"seconds"}), "--json")
            case = pathlib.Path(document["case"])
            self.expect(keys(json.loads((case / "certificate.json").read_text()), {"seconds"}), "certificate.json")
            self.expect(json.loads((case / "3-mesh/record.json").read_text()), "record.json")
            self.expect((case / "3-mesh/quality.csv").read_text().split("\n")[0].split(",")[:4], "quality.csv")
        for file in (self.at / "duck/3-mesh/mesh.vtu", self.at / "lens/3-mesh/too_thin.vtp",
                     self.at / "can/3-mesh/features.vtp"):
            fields = {name.decode() for name in re.findall(rb'Name="(\w+)"', file.read_bytes())}
            self.expect(fields - {"connectivity", "offsets", "types", "Points"}, file.name)
        check = json.loads(run("check", duck + "/3-mesh/mesh.vtu", "--json"))
        self.expect(keys(check), "--json of check")

    def test_tables_are_named(self):
        run("evolve", *BALL, "--h", ".4", "--t", "0:1:0", "-o", str(self.at / "moving"))
        self.expect((self.at / "moving/quality.csv").read_text().split("\n")[0].split(","), "quality.csv of evolve")
        (self.at / "list").write_text("nowhere.ply\n" + str(REPOSITORY / "data/clouds/duck.ply") + "\n")
        scans = json.loads(run("batch", str(self.at / "list"), "-o", str(self.at / "scans"), "--h", ".2", "--json", code=6))
        self.expect(keys(scans), "--json of batch")
        self.expect((self.at / "scans/batch.csv").read_text().split("\n")[0].split(","), "batch.csv")

    def test_the_table_of_parameters_is_fresh(self):
        check = subprocess.run([sys.executable, REPOSITORY / "tools/docs/parameters.py", PROGRAM, "--check"], capture_output=True, text=True)
        self.assertEqual(check.returncode, 0, check.stdout + check.stderr)

    def test_commands_are_documented(self):
        help_text = run("--help")
        commands = re.findall(r"^  (\w+) ", help_text[help_text.index("Subcommands:"):help_text.index("Examples:")], re.M)
        self.assertIn("run", commands)
        using = (REPOSITORY / "docs/using.md").read_text()
        for command in commands:
            self.assertIn(f"umtet {command} ", using)


if __name__ == "__main__":
    unittest.main()
