"""Artefacts with absurd content whose checksums are right all the same: refused by the reader, never believed."""
import ctypes
import re
import shutil
import struct
import unittest

from support import Folder, ellipsoid, run, write_ply

XXHASH = ctypes.CDLL("libxxhash.so.0")
NAN = struct.pack("<d", float("nan"))


class Hash128(ctypes.Structure):
    _fields_ = [("low", ctypes.c_uint64), ("high", ctypes.c_uint64)]


XXHASH.XXH3_128bits.restype = Hash128
XXHASH.XXH3_128bits.argtypes = [ctypes.c_char_p, ctypes.c_size_t]
XXHASH.XXH64.restype = ctypes.c_uint64
XXHASH.XXH64.argtypes = [ctypes.c_char_p, ctypes.c_size_t, ctypes.c_uint64]


def xxh3(content):
    h = XXHASH.XXH3_128bits(content, len(content))
    return f"{h.high:016x}{h.low:016x}"


def seal(text):
    """The checksum of a record: that of its text without white space and without the checksum itself."""
    compact = re.sub(r'("(?:[^"\\]|\\.)*")|\s+', lambda m: m.group(1) or "", text)
    return xxh3(re.sub(r',?"checksum":"[0-9a-f]{32}"', "", compact).encode())


def array(file, name):
    """Where the numbers of an array are in the appended data of a VTK file, and its bytes."""
    offset = int(re.search(rf'Name="{name}"[^>]* offset="(\d+)"/>'.encode(), file).group(1))
    at = file.index(b'<AppendedData encoding="raw">\n_') + 31 + offset
    size, = struct.unpack_from("<Q", file, at)
    return at + 8, file[at + 8:at + 8 + size]


def with_array(file, name, content):
    """The same file with other bytes of an array, as many."""
    begin, before = array(file, name)
    assert len(content) == len(before)
    return file[:begin] + content + file[begin + len(content):]


class Absurd(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.scope = Folder()
        cls.folder = cls.scope.__enter__()
        cls.addClassCleanup(cls.scope.__exit__)
        cls.plain = cls.folder / "plain"
        made = run("run", write_ply(cls.folder / "egg.ply", ellipsoid(250)), "-o", cls.plain, "--tets", 700)
        if made.returncode != 0:
            raise RuntimeError(made.stderr)

    def forged(self, file, content):
        """A case with another content of one file, in all records with the right size and checksum."""
        case = self.folder / "forged"
        shutil.rmtree(case, ignore_errors=True)
        shutil.copytree(self.plain, case)
        before = (case / file).read_bytes()
        (case / file).write_bytes(content)
        for record in case.glob("?-*/record.json"):
            text = record.read_text()
            held = re.search(r'"checksum": "([0-9a-f]{32})"', text).group(1)
            self.assertEqual(seal(text), held, "this test does not know how records are sealed")
            text = re.sub(rf'"size": \d+,(\s*)"xxh3": "{xxh3(before)}"',
                          rf'"size": {len(content)},\1"xxh3": "{xxh3(content)}"', text)
            record.write_text(text.replace(held, seal(text)))
        return case

    def refused(self, case, file, *call, codes=(3, 8)):
        result = run(*[case if word == "CASE" else word for word in call])
        self.assertIn(result.returncode, codes, f"{file}: {result.stderr}")
        self.assertIn(file.rsplit("/", 1)[1], result.stderr)

    def test_the_forgery_itself_is_believed(self):
        """Else the tests below would only show that checksums are compared."""
        file = "1-cloud/cloud.ply"
        content = (self.plain / file).read_bytes().replace(b"end_header", b"comment x\nend_header")
        again = run("run", self.forged(file, content), "--until", "cloud", "--strict")
        self.assertEqual(again.returncode, 0, again.stderr)

    def test_clouds(self):
        file = "1-cloud/cloud.ply"
        good = (self.plain / file).read_bytes()
        start = good.index(b"end_header\n") + 11
        for bad in (good[:start] + NAN * 6 * 250, good.replace(b"vertex 250", b"vertex 251"), b"ply\n"):
            self.refused(self.forged(file, bad), file, "reconstruct", "CASE", "--detail", 1.1)

    def test_level_sets(self):
        file = "2-level-set/level_set.vti"
        good = (self.plain / file).read_bytes()
        _, coefficients = array(good, "psi_a")
        absurd = NAN + coefficients[8:]
        for content in (absurd, NAN * (len(absurd) // 8)):
            h = XXHASH.XXH64(content, len(content), 0)
            text = with_array(with_array(good, "psi_a", content), "xxh64", struct.pack("<dd", h >> 32, h & 0xffffffff))
            self.refused(self.forged(file, text), file, "mesh", "CASE", "--tets", 900)
        _, lattice = array(good, "lattice")
        for content in (NAN + lattice[8:], lattice[:24] + struct.pack("<d", 0) + lattice[32:],
                        lattice[:32] + struct.pack("<d", 1e15) + lattice[40:]):
            self.refused(self.forged(file, with_array(good, "lattice", content)), file, "mesh", "CASE",
                         "--tets", 900)

    def test_meshes(self):
        file = "3-mesh/mesh.vtu"
        good = (self.plain / file).read_bytes()
        _, tets = array(good, "connectivity")
        for index in (10 ** 6, 2 ** 31 - 1, -1):
            text = with_array(good, "connectivity", struct.pack("<i", index) + tets[4:])
            self.refused(self.forged(file, text), file, "export", "CASE", "--format", "msh")
        _, points = array(good, "Points")
        text = with_array(good, "Points", NAN + points[8:])
        self.refused(self.forged(file, text), file, "export", "CASE", "--format", "msh")


if __name__ == "__main__":
    unittest.main()
