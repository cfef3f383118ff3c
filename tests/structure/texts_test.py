"""Texts of the libraries contain no flags of the program, which names options itself: texts_test.py SOURCES."""
import pathlib
import re
import sys
import unittest

SOURCES = pathlib.Path(sys.argv.pop(1)).resolve()
LIBRARIES = ("body", "common", "mesh", "reconstruct", "umtet")
COMMENT = re.compile(r"//[^\n]*")
TEXT = re.compile(r'"(?:[^"\\\n]|\\.)*"')
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

    def test_libraries_name_no_flags(self):
        for folder in LIBRARIES:
            for path in sorted((SOURCES / folder).rglob("*")):
                if path.suffix not in (".h", ".cpp"):
                    continue
                with self.subTest(path=str(path.relative_to(SOURCES))):
                    self.assertEqual(flags(path.read_text()), [])


if __name__ == "__main__":
    unittest.main()
