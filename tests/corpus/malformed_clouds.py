"""Cloud files that are wrong in one way each, and some that look wrong and are not. The same bytes at every call.

cases() yields (name, bytes, words): words that the refusal must have, the place among them, or None where the file is a
cloud of 100 points. usage: tests/corpus/malformed_clouds.py FOLDER"""
import math
import pathlib
import random
import struct
import sys

N = 100
NAMES = ("x", "y", "z", "nx", "ny", "nz")


def spiral_sphere():
    """N rows x y z nx ny nz of a sphere, normals outward."""
    rows = []
    for i in range(N):
        z, a = 1 - (2 * i + 1) / N, math.pi * (3 - math.sqrt(5)) * i
        r = math.sqrt(1 - z * z)
        n = (r * math.cos(a), r * math.sin(a), z)
        rows.append(tuple(c + .1 * u for c, u in zip((1, 2, 3), n)) + n)
    return rows


ROWS = spiral_sphere()
LINES = [" ".join(repr(v) for v in row) for row in ROWS]
TEXT = "\n".join(LINES) + "\n"


def binary(order="<", letter="f"):
    return b"".join(struct.pack(order + 6 * letter, *row) for row in ROWS)


def ply(form="binary_little_endian", kind="float", count=N, more="", names=NAMES):
    head = f"ply\nformat {form} 1.0\nelement vertex {count}\n"
    return (head + "".join(f"property {kind} {n}\n" for n in names) + more + "end_header\n").encode()


def pcd(data="binary", size="4", count="1", width=N, points=N, height=1):
    return (f"# .PCD v0.7 - Point Cloud Data file format\nVERSION 0.7\nFIELDS x y z normal_x normal_y normal_z\n"
            f"SIZE {' '.join([size] * 6)}\nTYPE F F F F F F\nCOUNT {count} 1 1 1 1 1\nWIDTH {width}\nHEIGHT {height}\n"
            f"VIEWPOINT 0 0 0 1 0 0 0\nPOINTS {points}\nDATA {data}\n").encode()


def with_line(i, line):
    return "\n".join(LINES[:i] + [line] + LINES[i + 1:]) + "\n"


def lzf_literals(data):
    """LZF without back references: runs of up to 32 bytes behind their length - 1."""
    return b"".join(bytes([len(data[i:i + 32]) - 1]) + data[i:i + 32] for i in range(0, len(data), 32))


def ply_cases():
    le, asc = ply() + binary(), ply("ascii") + TEXT.encode()
    face = "element face 1\nproperty list {} int vertex_indices\n"
    yield "ascii", asc, None
    yield "little", le, None
    yield "big", ply("binary_big_endian") + binary(">"), None
    yield "double", ply(kind="double") + binary(letter="d"), None
    yield "crlf", ply().replace(b"\n", b"\r\n") + binary(), None
    yield "long_comment", ply(more="comment " + 200000 * "c" + "\n") + binary(), None
    for index in (99999999, -7):
        yield f"face_index_{index}", ply(more=face.format("uchar")) + binary() + struct.pack("<Biii", 3, 0, 1, index), None
    yield "no_normals", ply(names=NAMES[:3]) + b"".join(struct.pack("<fff", *r[:3]) for r in ROWS), None
    yield "one_nan", ply("ascii") + with_line(41, "nan inf -inf nan nan nan").encode(), None
    yield "header_cut", le[:40], ["line 3"]
    yield "header_end_cut", le[:le.index(b"end_header")], ["end_header"]
    yield "body_cut", le[:1000], ["100", "cut short"]
    yield "body_cut_ascii", asc[:1500], ["line ", "cut short"]
    yield "body_none", ply(), ["100", "0 bytes are left"]
    for count in ("4000000000", "1000000000000000000", "18446744073709551615"):
        yield f"count_{count}", ply(count=count) + binary(), [count]
        yield f"count_{count}_ascii", ply("ascii", count=count) + TEXT.encode(), [count]
    for count in ("-5", "abc", "99999999999999999999", "1e2", "0x64", "", "100 100"):
        yield f"count_{count.replace(' ', '_')}", ply(count=count) + binary(), ["line 3"]
    # 768614336404564651 * 24 bytes are 2^64 + 8: in 64 bits that is 8.
    yield "count_wraps", ply(count="768614336404564651") + binary(), ["768614336404564651"]
    yield "all_nan", ply() + N * 6 * struct.pack("<f", math.nan), ["100 of 100"]
    yield "all_far", ply(kind="double") + N * 6 * struct.pack("<d", 1e300), ["100 of 100"]
    yield "no_vertices", ply(count=0), ["0 points"]
    yield "no_vertex_element", b"ply\nformat ascii 1.0\nelement face 0\nend_header\n", ["vertex"]
    yield "empty", b"", ["empty"]
    yield "only_magic", b"ply\n", ["end_header"]
    yield "no_end_header", le.replace(b"end_header\n", b""), ["line 10"]
    yield "list_255", ply(more=face.format("uchar")) + binary() + struct.pack("<Biii", 255, 0, 1, 2), ["face 1 of 1"]
    yield "list_uint", ply(more=face.format("uint")) + binary() + struct.pack("<Iiii", 0xfffffff0, 0, 1, 2), ["face 1 of 1"]
    yield "list_negative", ply(more=face.format("char")) + binary() + b"\xff", ["negative"]
    yield "list_in_vertex", ply(more="property list uint double w\n") + binary(), ["100 x vertex"]
    yield "list_count_float", ply(more=face.format("float")) + binary() + struct.pack("<fiii", 3, 0, 1, 2), ["line 11"]
    yield "list_ascii", ply("ascii", more=face.format("uchar")) + TEXT.encode() + b"255 0 1 2\n", ["line 113"]
    yield "faces_4e9", ply(more=face.format("uchar").replace(" 1\n", " 4000000000\n")) + binary(), ["face"]
    yield "empty_elements_1e18", ply(more="element e 1000000000000000000\n") + binary(), None
    yield "float128", ply(kind="float128") + binary(), ["line 4", "float128"]
    yield "two_vertex", ply(more=f"element vertex {N}\n") + binary(), ["line 10"]
    yield "two_x", ply(names=("x", "x") + NAMES[2:]) + binary(), ["x more than once"]
    yield "no_y", ply(names=("x",) + NAMES[2:]) + binary(), ["no property y"]
    yield "commas", ply("ascii") + TEXT.replace(".", ",").encode(), ["line 11", "comma"]
    yield "nul_in_row", ply("ascii") + TEXT.replace(" ", "\0", 1).encode(), ["line 11"]
    yield "hex_numbers", ply("ascii") + with_line(0, "0x1p1 2 3 0 0 1").encode(), ["line 11"]
    yield "long_token", ply("ascii") + with_line(3, 100000 * "9" + " 2 3 0 0 x").encode(), ["line 14"]
    properties = "".join(f"property uchar p{i}\n" for i in range(10000))
    yield "ten_thousand_properties", ply(more=properties), ["10024 bytes"]
    yield "many_elements", ply(more="".join(f"element e{i} 0\n" for i in range(10000))) + binary(), ["too many"]
    yield "random", random.Random(1).randbytes(5000), ["line 1"]
    yield "random_body", ply("ascii") + random.Random(1).randbytes(5000), ["line 11"]
    yield "zeros", bytes(1 << 20), ["line 1"]
    yield "utf16", asc.decode().encode("utf-16"), ["line 1"]
    yield "bom", b"\xef\xbb\xbf" + asc, ["line 1"]
    yield "old_mac", asc.replace(b"\n", b"\r"), ["line 1"]
    yield "format_middle_endian", asc.replace(b"ascii", b"binary_middle_endian"), ["line 2"]
    yield "no_format", asc.replace(b"format ascii 1.0\n", b""), ["no format"]
    yield "plane", ply("ascii") + "".join(f"{i % 10} {i // 10} 0 0 0 1\n" for i in range(N)).encode(), ["plane"]
    yield "twelve_places", ply("ascii") + "".join(LINES[i % 12] + "\n" for i in range(N)).encode(), ["12 different places"]
    yield "tiny", ply(kind="double") + b"".join(struct.pack("<6d", *(1e-60 * v for v in r)) for r in ROWS), ["1e-50"]
    yield "huge", ply(kind="double") + b"".join(struct.pack("<6d", *(1e60 * v for v in r)) for r in ROWS), ["1e50"]
    yield "one_place", ply("ascii") + (N * "1 2 3 0 0 1\n").encode(), ["1 different places"]


def pcd_cases():
    data = struct.pack
    fields = b"".join(struct.pack("<100f", *(row[a] for row in ROWS)) for a in range(6))
    packed = lzf_literals(fields)
    block = data("<II", len(packed), len(fields)) + packed
    yield "ascii", pcd("ascii") + TEXT.encode(), None
    yield "binary", pcd() + binary(), None
    yield "compressed", pcd("binary_compressed") + block, None
    yield "binary_cut", (pcd() + binary())[:1000], ["100 points", "cut short"]
    yield "ascii_cut", (pcd("ascii") + TEXT.encode())[:4000], ["line ", "cut short"]
    yield "points_4e9", pcd(width="4000000000", points="4000000000") + binary(), ["4000000000"]
    yield "points_4e9_ascii", pcd("ascii", width="4000000000", points="4000000000") + TEXT.encode(), ["4000000000"]
    # 65536 * 65536 is 0 in 32 bits; 2^32 * 2^32 is 0 in 64.
    yield "width_height_wrap", pcd(width=65536, height=65536, points=0) + binary(), ["POINTS"]
    yield "width_height_wrap_64", pcd(width=1 << 32, height=1 << 32, points=0) + binary(), ["line "]
    yield "width_wrong", pcd(width=90) + binary(), ["POINTS 100", "WIDTH 90"]
    yield "count_negative", pcd(count="-1") + binary(), ["COUNT", "-1"]
    yield "count_zero", pcd(count="0") + binary(), ["COUNT"]
    yield "count_2e9", pcd(count="2000000000") + binary(), ["COUNT 2000000000"]
    yield "size_0", pcd(size="0") + binary(), ["SIZE", "'0'"]
    yield "size_3", pcd(size="3") + binary(), ["line 5", "SIZE 3"]
    yield "type_unknown", pcd().replace(b"TYPE F", b"TYPE Q") + binary(), ["'Q'"]
    yield "lying_block", pcd("binary_compressed") + data("<II", 0xfffffff0, 0xfffffff0) + packed, ["are left"]
    yield "lying_unpacked", pcd("binary_compressed") + data("<II", len(packed), 0xfffffff0) + packed, ["4294967280"]
    yield "compressed_cut", pcd("binary_compressed") + block[:700], ["are left"]
    yield "compressed_wrong_size", pcd("binary_compressed") + data("<II", len(packed), 2376) + packed, ["damaged"]
    yield "compressed_random", (pcd("binary_compressed") + block[:8] +
                                random.Random(1).randbytes(len(packed))), ["cannot be unpacked"]
    # A back reference to before the first byte.
    yield "compressed_back", pcd("binary_compressed") + block[:8] + b"\xff" * len(packed), ["cannot be unpacked"]
    bomb = pcd("binary_compressed", width=80000000, points=80000000)
    yield "compressed_bomb", bomb + data("<II", 4, 1920000000) + b"aaaa", ["1920000000"]
    yield "no_block", pcd("binary_compressed") + b"abc", ["no compressed block"]
    yield "empty", b"", ["empty"]
    yield "no_fields", pcd().replace(b"FIELDS x y z normal_x normal_y normal_z\n", b"") + binary(), ["FIELDS"]
    yield "bare_data", b"VERSION .7\nDATA\n", ["FIELDS"]
    yield "data_unknown", pcd("binary_zipped") + binary(), ["binary_zipped"]
    yield "data_missing", pcd()[:pcd().index(b"DATA")], ["DATA"]
    yield "random", random.Random(2).randbytes(5000), ["line 1"]


def xyz_cases():
    yield "six", TEXT.encode(), None
    yield "three", "".join(" ".join(line.split()[:3]) + "\n" for line in LINES).encode(), None
    yield "empty", b"", ["empty"]
    yield "two_columns", b"1 2\n" * N, ["line 1"]
    yield "ragged", with_line(6, "1 2 3").encode(), ["line 7"]
    yield "word", ("x y z\n" + TEXT).encode(), ["line 1", "'x'"]
    yield "commas", TEXT.replace(".", ",").encode(), ["line 1", "decimal"]
    yield "overflow", with_line(6, "1e999 0 0 0 0 1").encode(), ["line 7"]
    yield "one_long_line", b"1 " * 500000, ["line 1"]
    yield "nul", bytes(5000), ["line 1"]
    yield "random", random.Random(3).randbytes(5000), ["line 1"]


def cases():
    for suffix, family in ((".ply", ply_cases), (".pcd", pcd_cases), (".xyz", xyz_cases)):
        for name, data, words in family():
            yield name + suffix, data, words


if __name__ == "__main__":
    folder = pathlib.Path(sys.argv[1])
    folder.mkdir(parents=True, exist_ok=True)
    for name, data, _ in cases():
        (folder / name).write_bytes(data)
