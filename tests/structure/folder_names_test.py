"""Names in the anonymous namespaces of a folder that UMTET_UNITY compiles as one source differ: folder_names_test.py SOURCES."""
import pathlib
import re
import sys
import unittest

SOURCES = pathlib.Path(sys.argv.pop(1)).resolve()
FOLDERS = ("common/vtk_xml", "reconstruct", "mesh", "body", "pipeline")


def of_anonymous_namespaces(text):
    return "".join(re.findall(r"^namespace \{\n(.*?)^\}  // namespace$", text, re.M | re.S))


def definitions(text):
    """(name, what a second one must equal, or None): constants, types and functions that are defined outside of functions."""
    for line in re.findall(r"^(?:inline |static )?constexpr .*", text, re.M):
        for name in re.findall(r"\b(k[A-Z]\w*)(?=\s*(?:=|\{|\[))", line):
            yield name, None
    for name in re.findall(r"^(?:class|struct|enum class|enum|union) (\w+)[^;\n]*\{", text, re.M):
        yield name, None
    for name, type_ in re.findall(r"^using (\w+) = ([^;]*);", text, re.M):
        yield name, type_
    for name, arguments in re.findall(r"^(?!using|namespace|return|constexpr k)\w[\w:<>,&*\[\]{}= ]*[ &*](\w+)\(([^()]*)\)(?: noexcept)? \{", text, re.M):
        yield f"{name}({' '.join(arguments.split())})", None


def twice_defined(texts):
    """Names that two sources of a folder define, with these sources; texts by source."""
    found, first = [], {}
    for source, text in texts.items():
        for name, same in set(definitions(of_anonymous_namespaces(text))):
            other, other_same = first.setdefault(name, (source, same))
            if other != source and (same is None or same != other_same):
                found.append((name, other, source))
    return found


def alone(cmake):
    """The sources that umtet_unity() is told to leave alone."""
    return {name for call in re.findall(r"umtet_unity\(([^)]*)\)", cmake) for name in call.split()[1:]}


class Rules(unittest.TestCase):
    def test_a_name_is_found_twice(self):
        a = "namespace {\nconstexpr double kA = 1, kB = 2;\nusing Edge = int;\nint f(int x) {\n}\n}  // namespace\nconstexpr int kC = 1;\n"
        self.assertEqual(twice_defined({"a": a, "b": "namespace {\nconstexpr int kB{3};\n}  // namespace\n"}), [("kB", "a", "b")])
        self.assertEqual(len(twice_defined({"a": a, "b": a})), 3)  # two constants and the function
        self.assertEqual(twice_defined({"a": a, "b": "namespace {\nusing Edge = long;\n}  // namespace\n"}), [("Edge", "a", "b")])
        self.assertEqual(twice_defined({"a": a, "b": "namespace {\nint f(double x) {\n}\nclass A;\n}  // namespace\nconst int kC = 2;\n"}), [])

    def test_sources_left_alone(self):
        self.assertEqual(alone("umtet_unity(umtet_mesh\n  a.cpp b/c.cpp)\numtet_unity(umtet_body)\n"), {"a.cpp", "b/c.cpp"})


class Sources(unittest.TestCase):
    def test_names_of_a_folder_differ(self):
        left = {file.parent / name for file in SOURCES.glob("*/CMakeLists.txt") for name in alone(file.read_text())}
        found, n = [], 0
        for folder in (f for top in FOLDERS for f in ((SOURCES / top), *(SOURCES / top).rglob("*/"))):
            sources = [file for file in sorted(folder.glob("*.cpp")) if file not in left]
            n += len(sources)
            found += twice_defined({file.relative_to(SOURCES).as_posix(): file.read_text() for file in sources})
        self.assertGreater(n, 350)
        self.assertEqual(found, [])


if __name__ == "__main__":
    unittest.main()
