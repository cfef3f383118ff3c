"""Includes go the way that folders.txt declares, and nobody else reads the headers of a detail/: includes_test.py SOURCES."""
import pathlib
import re
import sys
import unittest

SOURCES = pathlib.Path(sys.argv.pop(1)).resolve()
TOPS = ("common", "mesh", "distributed", "reconstruct", "body", "umtet", "pipeline", "python", "pcl", "openmesh", "examples", "tools")


def declared(text):
    """What each folder names, by folder."""
    lines = (line.split("#")[0].strip() for line in text.splitlines() if not line.startswith("not "))
    return {folder.strip(): names.split() for folder, _, names in (line.partition(":") for line in lines if line)}


def forbidden(text):
    """What a folder may not include itself, by folder: folders, and headers that it may."""
    found = {}
    for line in text.splitlines():
        if line.startswith("not "):
            folder, _, names = line.removeprefix("not ").partition(":")
            others, _, headers = names.partition(" but ")
            found[folder.strip()] = (others.split(), headers.split())
    return found


def is_forbidden(file, included, rules):
    return any(file.startswith(folder + "/") and included not in headers and included.startswith(tuple(f"{o}/" for o in others))
               for folder, (others, headers) in rules.items())


def twice_defined(headers):
    """Classes of one namespace that several headers define, by name."""
    where = {}
    for file, text in headers.items():
        spaces = set(re.findall(r"^namespace ([\w:]+) \{", text, re.M))
        for name in re.findall(r"^(?:class|struct) (\w+)(?: final)?\s*(?::[^;{]*)?\{", text, re.M):
            where.setdefault((name, *sorted(spaces)), set()).add(file)
    return {key[0]: sorted(files) for key, files in where.items() if len(files) > 1}


def reach(folder, named, path=()):
    """A folder, what it names and what these may include. ValueError for a folder that comes back to itself."""
    if folder in path:
        raise ValueError("a cycle: " + " -> ".join((*path, folder)))
    return {folder}.union(*(reach(name, named, (*path, folder)) for name in named[folder]))


def folder_of(file, named):
    """The longest declared folder that a file is in; files of mesh/ itself are in mesh, those of mesh/new in none."""
    parts = pathlib.PurePosixPath(file).parts[:-1]
    for n in range(len(parts), 0, -1):
        folder = "/".join(parts[:n])
        if folder in named:
            whole = n == len(parts) or not any(name.startswith(folder + "/") for name in named)
            return folder if whole else None
    return None


def wrong(file, included, named):
    """What is wrong with an include, or None. Names are from the root of the sources."""
    here, there = folder_of(file, named), folder_of(included, named)
    if here is None or there is None:
        return f"{file if here is None else included} is in no declared folder"
    if there not in reach(here, named):
        return f"{here} may not include {there}"
    if "/detail/" in included:
        if not file.startswith(included.split("/detail/")[0] + "/"):
            return "a detail/ of another folder"
        if file.endswith(".h") and "/detail/" not in file:
            return "a public header includes a detail/"
    return None


# The libraries without files, flags and documents: what these include of others.
WITHOUT = dict.fromkeys(("body", "umtet"), ("fmt/", "nlohmann/", "vtk", "CLI/", "toml++/", "filesystem", "fstream"))


class Includes(unittest.TestCase):
    def setUp(self):
        text = (pathlib.Path(__file__).parent / "folders.txt").read_text()
        self.named, self.rules = declared(text), forbidden(text)

    def test_the_declaration_has_no_cycle(self):
        for folder in self.named:
            reach(folder, self.named)

    def test_every_include_is_declared(self):
        n, found = 0, []
        for top in TOPS:
            for path in sorted((SOURCES / top).rglob("*")):
                if path.suffix not in (".h", ".cpp"):
                    continue
                file = path.relative_to(SOURCES).as_posix()
                for included in re.findall(r'^\s*#\s*include\s+"([^"]+)"', path.read_text(), re.M):
                    n += 1
                    reason = wrong(file, included, self.named)
                    if reason:
                        found.append(f"{file} -> {included}: {reason}")
                    if is_forbidden(file, included, self.rules):
                        found.append(f"{file} -> {included}: this folder may not include it itself")
        self.assertGreater(n, 500)
        self.assertEqual(found, [], "\n" + "\n".join(found))

    def test_some_libraries_stay_outside(self):
        for top, outside in WITHOUT.items():
            files = [path for path in sorted((SOURCES / top).rglob("*")) if path.suffix in (".h", ".cpp")]
            self.assertGreater(len(files), 1)
            for path in files:
                for included in re.findall(r"^\s*#\s*include\s+<([^>]+)>", path.read_text(), re.M):
                    self.assertFalse(included.startswith(outside), f"{path.relative_to(SOURCES)} includes <{included}>")

    def test_no_two_classes_have_one_name(self):
        # The linker keeps one destructor of two classes umtet::X, and frees the members of the other with it.
        headers = {str(f.relative_to(SOURCES)): f.read_text() for top in TOPS for f in (SOURCES / top).rglob("*.h")}
        self.assertEqual(twice_defined(headers), {})
        self.assertEqual(twice_defined({"a.h": "namespace umtet {\nclass X {", "b.h": "namespace umtet {\nstruct X : Y {"}),
                         {"X": ["a.h", "b.h"]})
        self.assertEqual(twice_defined({"a.h": "namespace umtet {\nclass X {", "b.h": "namespace umtet::b {\nclass X {"}), {})

    def test_wrong_includes_are_found(self):
        named = declared("a: # all\nb: a\nb/c: a\nd: b")
        self.assertIsNone(wrong("d/x.cpp", "a/y.h", named))
        self.assertIsNone(wrong("d/x.cpp", "d/detail/y.h", named))
        for file, included in (("a/x.cpp", "b/y.h"), ("b/x.cpp", "b/c/y.h"), ("d/x.cpp", "b/detail/y.h"),
                               ("d/x.h", "d/detail/y.h"), ("e/x.cpp", "a/y.h"), ("b/new/x.cpp", "a/y.h")):
            self.assertIsNotNone(wrong(file, included, named), f"{file} -> {included}")
        rules = forbidden("not d: b but b/y.h")
        for included, is_wrong in (("b/y.h", False), ("b/c/z.h", True), ("a/y.h", False)):
            self.assertEqual(is_forbidden("d/e/x.cpp", included, rules), is_wrong, included)
        with self.assertRaises(ValueError):
            reach("a", declared("a: b\nb: a"))


if __name__ == "__main__":
    unittest.main()
