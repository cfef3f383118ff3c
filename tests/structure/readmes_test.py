"""READMEs name every header of their folder. Documents name no file that does not exist, their tables are well-formed and
their links resolve: readmes_test.py SOURCES."""
import pathlib
import re
import sys
import unittest

SOURCES = pathlib.Path(sys.argv.pop(1)).resolve()
# Folders whose READMEs name every header.
TOPS = ("common", "reconstruct", "mesh", "body", "umtet", "distributed", "pipeline", "python", "pcl", "openmesh")
PUBLIC = (*TOPS[:6], "openmesh/umtet", "pcl/umtet")  # what the API reference reads
INNER = {"detail", "tables", "tilings"}  # a README names these folders as a whole
CODE = re.compile(r"`([^`\n]+)`")
NO_FILES = {"mesh.h", "docs/api/html"}  # a parameter; made by doxygen
LINK = re.compile(r"\]\(([^()\s]+)\)")
SEPARATOR = re.compile(r"\|(\s*:?-+:?\s*\|)+")


def documents():
    """All Markdown files of the sources."""
    for path in sorted(SOURCES.rglob("*.md")):
        parts = path.relative_to(SOURCES).parts
        if not any(p.startswith((".", "build")) for p in parts[:-1]):
            yield path


def prose(text):
    """Lines with their numbers, without blocks of code: fenced, or indented behind an empty line."""
    fenced = indented = False
    before = ""
    for n, line in enumerate(text.split("\n"), 1):
        if line.startswith("```"):
            fenced = not fenced
        indented = line.startswith("    ") and (indented or not before.strip())
        if not fenced and not line.startswith("```") and not indented:
            yield n, line
        before = line


def columns(row):
    return len(re.findall(r"(?<!\\)\|", row.strip())) - 1


def broken_tables(text):
    """[(line, what is wrong)] of the tables of a document."""
    found, rows, former = [], [], 0
    for n, line in [*prose(text), (0, "")]:
        is_row = line.startswith("|") and n == former + 1 if rows else line.startswith("|")
        if rows and not is_row:
            first = rows[0][0]
            if len(rows) < 2 or not SEPARATOR.fullmatch(rows[1][1].strip()):
                found.append((first, "a table without a line of |---|"))
            found += [(k, f"{columns(row)} columns, the first row has {columns(rows[0][1])}")
                      for k, row in rows if columns(row) != columns(rows[0][1]) or not row.rstrip().endswith("|")]
            rows = []
        if line.startswith("|"):
            rows.append((n, line))
        former = n
    return found


def broken_lists(text):
    """[(line, what is wrong)]: the rest of a line that an item should begin, or an item whose text is missing."""
    return [(n, "an item without text") for n, line in prose(text) if re.fullmatch(r"\s*([-*]|\d+\.)\s*", line)]


def anchor(heading):
    """The anchor that a page gives a heading."""
    words = re.sub(r"\[([^]]*)\]\([^)]*\)", r"\1", heading).replace("`", "").strip().lower()
    return re.sub(r"[^\w\- ]", "", words).replace(" ", "-")


def anchors(path):
    return {anchor(line.lstrip("#")) for _, line in prose(path.read_text()) if re.match(r"#+ ", line)}


def broken_links(path):
    """Links of a document to files or headings that do not exist."""
    found = []
    for target in LINK.findall("\n".join(line for _, line in prose(path.read_text()))):
        if re.match(r"[a-z]+:", target):
            continue
        name, _, heading = target.partition("#")
        file = (path.parent / name).resolve() if name else path
        if not file.exists() or heading and file.suffix == ".md" and heading not in anchors(file):
            found.append(target)
    return found


def source_files():
    """All files of the sources as "/folder/name"."""
    return ["/" + path.relative_to(SOURCES).as_posix() for path in SOURCES.rglob("*")
            if not any(p.startswith((".", "build")) for p in path.relative_to(SOURCES).parts[:-1])]


def missing_files(text, folder, files):
    """Names in code style that look like files of the sources and are none. @param folder  of the document"""
    found = []
    for token in CODE.findall("\n".join(line for _, line in prose(text))):
        if token in NO_FILES or token.startswith("build/"):
            continue
        top = (SOURCES / token.split("/")[0]).is_dir()
        if re.fullmatch(r"[\w./-]+\.(h|cpp)", token) or re.fullmatch(r"[\w.-]+/[\w./-]+\.(py|toml|csv|md)", token) and top:
            if not any(file.endswith("/" + token) for file in files):
                found.append(token)
        elif (pair := re.fullmatch(r"([a-z_]+)/([\w/]+)", token)) and (folder / pair[1]).is_dir():
            if not any((root / (token + end)).exists() for root in (folder, SOURCES) for end in ("", ".h", ".cpp", ".py")):
                found.append(token)
    return found


def readme_of(header):
    """The README that has to name a header: that of its folder, or the next one above."""
    return next(folder / "README.md" for folder in header.parents if (folder / "README.md").exists())


class Readmes(unittest.TestCase):
    def expect_none(self, found):
        self.assertEqual(found, [], "\n" + "\n".join(found))

    def test_every_header_is_named(self):
        n, found = 0, []
        for top in TOPS:
            for header in sorted((SOURCES / top).rglob("*.h")):
                if INNER.intersection(header.relative_to(SOURCES).parts):
                    continue
                n += 1
                readme = readme_of(header)
                if not re.search(rf"`(?:[\w/]+/)?{re.escape(header.name)}`", readme.read_text()):
                    found.append(f"{readme.relative_to(SOURCES)} does not name {header.relative_to(readme.parent)}")
        self.assertGreater(n, 100)
        self.expect_none(found)

    def test_the_api_reference_reads_every_library(self):
        inputs = re.search(r"^INPUT\s*=(.*)$", (SOURCES / "tools/docs/Doxyfile").read_text(), re.M)[1].split()
        self.assertEqual([top for top in PUBLIC if top not in inputs], [])

    def test_every_named_file_exists(self):
        files = source_files()
        self.expect_none([f"{path.relative_to(SOURCES)}: there is no {token}" for path in documents() if path.name != "CHANGELOG.md"
                          for token in missing_files(path.read_text(), path.parent, files)])

    def test_tables_and_lists_are_well_formed(self):
        self.expect_none([f"{path.relative_to(SOURCES)}:{n}: {what}" for path in documents()
                          for n, what in (*broken_tables(path.read_text()), *broken_lists(path.read_text()))])

    def test_links_resolve(self):
        self.expect_none([f"{path.relative_to(SOURCES)}: {target}" for path in documents() for target in broken_links(path)])

    def test_faults_are_found(self):
        self.assertEqual(broken_tables("| a | b |\n|---|---|\n| 1 | x \\| y |\n\ntext"), [])
        self.assertEqual(broken_tables("    | code\n\n```\n| code\n```"), [])
        for table in ("| a | b |\n|---|---|\n| 1 |", "| a | b |\n| -- -| -- -|\n| 1 | 2 |", "| a |", "|a|\n|---|\n|1", "|a|\n|---|\n\n|1|"):
            self.assertNotEqual(broken_tables(table), [], table)
        self.assertNotEqual(broken_lists("text\n-\n- more"), [])
        self.assertEqual(anchor(" What is `--h`, and (1)?"), "what-is---h-and-1")
        self.assertEqual(missing_files("`common/vec3.h` `no_such.h` `mesh.vtu`", SOURCES, ["/common/vec3.h"]), ["no_such.h"])
        self.assertEqual(missing_files("`core/orientation` `core/no_such`", SOURCES / "mesh", []), ["core/no_such"])


if __name__ == "__main__":
    unittest.main()
