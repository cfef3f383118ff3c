"""Citation keys in sources and documents are those of REFERENCES.bib, and all of these are cited: citations_test.py SOURCES."""
import pathlib
import re
import sys
import unittest

SOURCES = pathlib.Path(sys.argv.pop(1)).resolve()
KEY = r"[A-Z][A-Za-z]+(?:18|19|20)\d{2}[a-z]?"
ENTRY = re.compile(r"^@\w+\{\s*([^,\s]+)\s*,", re.M)
# [Key2018], [Key2018, Section 3], [KeyA2018; KeyB2019, eq. (1)]: a citation may go on behind a line's end.
CITATION = re.compile(r"\[(" + KEY + r"(?=[\],;])[^\[\]]{0,300})\]")
COMMENT = re.compile(r"\n\s*(?:///?|#|\*)?\s*")
KINDS = (".h", ".cpp", ".md", ".py")


def citations(text):
    """The keys of all citations in a text, in their order."""
    keys = []
    for inner in CITATION.findall(text):
        for part in COMMENT.sub(" ", inner).split(";"):
            key = re.match(r"\s*(" + KEY + r")(?=\s*(?:,|$))", part)
            if key:
                keys.append(key.group(1))
    return keys


def sources():
    for path in sorted(SOURCES.rglob("*")):
        parts = path.relative_to(SOURCES).parts
        hidden = any(p == ".git" or p.startswith("build") for p in parts[:-1])
        if path.suffix in KINDS and not hidden and path.is_file() and path.resolve() != pathlib.Path(__file__).resolve():
            yield path


class Citations(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.entries = ENTRY.findall((SOURCES / "REFERENCES.bib").read_text())
        cls.cited = {}  # key: the files that cite it
        for path in sources():
            for key in citations(path.read_text(errors="replace")):
                cls.cited.setdefault(key, set()).add(str(path.relative_to(SOURCES)))

    def test_a_citation_is_found_in_every_form(self):
        self.assertEqual(citations("a [Ab1999] b [Cd2001, eqs. (2), (4)] c [Ef2002a; Gh2003, Section 3]"),
                         ["Ab1999", "Cd2001", "Ef2002a", "Gh2003"])
        self.assertEqual(citations("/// text [Ab1999, eqs. (1),\n/// (2)]\n// [Cd2001;\n  // Ef2002]"), ["Ab1999", "Cd2001", "Ef2002"])
        self.assertEqual(citations("x[Size2048 + 1] [0, 1] [link](Ab1999) [a1999] [Ab99]"), [])

    def test_something_is_cited(self):
        self.assertTrue(self.entries)
        self.assertTrue(self.cited)

    def test_every_key_has_an_entry(self):
        missing = {key: sorted(files) for key, files in self.cited.items() if key not in self.entries}
        self.assertEqual(missing, {}, "cited, but not in REFERENCES.bib")

    def test_every_entry_is_cited(self):
        self.assertEqual([e for e in self.entries if e not in self.cited], [], "in REFERENCES.bib, but cited nowhere")

    def test_no_entry_is_there_twice(self):
        self.assertEqual(sorted(set(self.entries)), sorted(self.entries))


if __name__ == "__main__":
    unittest.main()
