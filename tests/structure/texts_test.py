"""Texts of the libraries contain no flags of the program, which names options itself. Public headers and documents
contain no phrases of an accent: texts_test.py SOURCES."""
import pathlib
import re
import sys
import unittest

SOURCES = pathlib.Path(sys.argv.pop(1)).resolve()
LIBRARIES = ("body", "common", "mesh", "reconstruct", "umtet")
COMMENT = re.compile(r"//[^\n]*")
TEXT = re.compile(r'"(?:[^"\\\n]|\\.)*"')
HEADERS = (*LIBRARIES, "distributed", "pipeline", "python", "pcl", "openmesh")
# Half-sentences that go on with the declaration; passive verbs for requested, required, reported; words for numbers.
ACCENT = re.compile(r"///< (?:of|that|those|what|which|whose)\b|\b(?:is|are) (?:asked for|wanted|said|told)\b|"
                    r"\b(?:hardly|as far as|so many)\b|^\W*(?:What|Those|Of) [a-z]+ .*\b(?:is|are|has|have)\b.*\.$")
FLAG = re.compile(r"(?<![\w-])--[a-z]")


def flags(source):
    """The texts in the source of a program that name a flag."""
    found, at = [], 0
    while match := re.compile(COMMENT.pattern + "|" + TEXT.pattern).search(source, at):
        at = match.end()
        if match[0].startswith('"') and FLAG.search(match[0]):
            found.append(match[0])
    return found


class Texts(unittest.TestCase):
    def test_flags_are_found_in_texts_alone(self):
        self.assertEqual(flags('f("give --h"); // "--tets"\n--i; g("a--b", "https://x"); h("\\"--box")'),
                         ['"give --h"', '"\\"--box"'])

    def test_an_accent_is_found(self):
        for line in ("int a;  ///< of the mesh", "/// It is said why.", "as far as the box goes", "/// What is not known has no name."):
            self.assertIsNotNone(ACCENT.search(line), line)
        for line in ("int a;  ///< faces of the mesh", "/// Of course.", "## What is `--h`?", "the report says why"):
            self.assertIsNone(ACCENT.search(line), line)

    def test_headers_and_documents_have_no_accent(self):
        paths = [path for top in HEADERS for path in sorted((SOURCES / top).rglob("*.h"))]
        paths += [*(SOURCES / "docs").glob("*.md"), *SOURCES.glob("*.md"), *(p for top in HEADERS for p in (SOURCES / top).rglob("README.md"))]
        self.assertGreater(len(paths), 400)
        found = []
        for path in paths:
            name = path.relative_to(SOURCES).as_posix()
            if name != "CHANGELOG.md":
                found += [f"{name}:{n}: {line.strip()}" for n, line in enumerate(path.read_text().split("\n"), 1) if ACCENT.search(line)]
        self.assertEqual(found, [], "\n" + "\n".join(found))

    def test_libraries_name_no_flags(self):
        for folder in LIBRARIES:
            for path in sorted((SOURCES / folder).rglob("*")):
                if path.suffix not in (".h", ".cpp"):
                    continue
                with self.subTest(path=str(path.relative_to(SOURCES))):
                    self.assertEqual(flags(path.read_text()), [])


if __name__ == "__main__":
    unittest.main()
