"""The corpus: files that are wrong in one way each, and some that look wrong and are not, with what must become of them.

Files of some kilobytes that were found or written by other programs are in files/, the others are made here, the same bytes at
every call. One table for all who read them: the program and the readers (corpus_test.py), the fuzz targets (tests/fuzz), for
which they are seeds.

    cases.py FOLDER    writes what is made here to FOLDER/TARGET, TARGET that of the fuzz target
"""
import base64
import dataclasses
import gzip
import math
import pathlib
import random
import struct
import sys
import zlib

STORED = pathlib.Path(__file__).resolve().parent / "files"
TARGETS = {".stl": "triangles_stl", ".obj": "triangles_obj", ".off": "triangles_off",
           ".ply": "cloud_ply", ".pcd": "cloud_pcd", ".xyz": "cloud_xyz", ".pts": "cloud_xyz", ".csv": "cloud_xyz",
           ".asc": "cloud_xyz", ".vti": "level_set",
           ".vtu": "mesh_vtu", ".msh": "mesh_msh", ".mesh": "mesh_mesh", ".inp": "mesh_inp",
           ".nrrd": "grid_nrrd", ".nii": "grid_nifti", ".vtk": "grid_vtk",
           ".feat": "lines", ".eMesh": "lines", ".lines": "lines",  # of OBJ
           ".grid": "grid_vti"}  # ImageData, which has any name here: .vti is that of our own level sets
EDGES = (".feat", ".eMesh", ".lines")  # of the cube of TRIANGLES
GRIDS = (".nrrd", ".nii", ".vtk", ".grid")


@dataclasses.dataclass
class Case:
    name: str
    data: bytes
    # What the refusal must say, the place among it; None: accepted. The program (exit code 3) and the readers agree, but
    # read_point_cloud, which asks for clean points with normals, may have words of its own.
    words: list | None
    strict: list | None
    is_huge: bool = False  # zeros follow the data
    target: str = None  # of fuzzing, where the suffix does not tell


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
    yield "no_normals", ply(names=NAMES[:3]) + b"".join(struct.pack("<fff", *r[:3]) for r in ROWS), None, ["no normals", "nx, ny, nz", "CloudCompare"]
    yield "one_nan", ply("ascii") + with_line(41, "nan inf -inf nan nan nan").encode(), None, ["point 42 ", "1 such"]
    yield "header_cut", le[:40], ["line 3", "'elem'"]
    yield "header_end_cut", le[:le.index(b"end_header")], ["end_header", "cut short"]
    yield "body_cut", le[:1000], ["100", "bytes are left", "cut short"]
    yield "body_cut_ascii", asc[:1500], ["line ", "cut short"]
    yield "body_none", ply(), ["100", "0 bytes are left"]
    for count in ("4000000000", "1000000000000000000", "18446744073709551615"):
        yield f"count_{count}", ply(count=count) + binary(), [count, "2400 bytes are left"]
        yield f"count_{count}_ascii", ply("ascii", count=count) + TEXT.encode(), [count, "line 11"]
    for count in ("-5", "abc", "99999999999999999999", "1e2", "0x64", "", "100 100"):
        yield f"count_{count.replace(' ', '_')}", ply(count=count) + binary(), ["line 3", count.split()[0] if count.split() else ""]
    # 768614336404564651 * 24 bytes are 2^64 + 8: in 64 bits that is 8.
    yield "count_wraps", ply(count="768614336404564651") + binary(), ["768614336404564651"]
    yield "all_nan", ply() + N * 6 * struct.pack("<f", math.nan), ["100 of 100"], ["point 1 ", "100 such"]
    yield "all_far", ply(kind="double") + N * 6 * struct.pack("<d", 1e300), ["100 of 100"], ["point 1 ", "1e50"]
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
    yield "list_ascii", ply("ascii", more=face.format("uchar")) + TEXT.encode() + b"255 0 1 2\n", ["line 113", "list length"]
    yield "faces_4e9", ply(more=face.format("uchar").replace(" 1\n", " 4000000000\n")) + binary(), ["face"]
    yield "empty_elements_1e18", ply(more="element e 1000000000000000000\n") + binary(), None
    yield "float128", ply(kind="float128") + binary(), ["line 4", "float128"]
    yield "two_vertex", ply(more=f"element vertex {N}\n") + binary(), ["line 10"]
    yield "two_x", ply(names=("x", "x") + NAMES[2:]) + binary(), ["x more than once"]
    yield "no_y", ply(names=("x",) + NAMES[2:]) + binary(), ["no property y"]
    yield "commas", ply("ascii") + TEXT.replace(".", ",").encode(), ["line 11", "decimal comma"]
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
    yield "twelve_places", ply("ascii") + "".join(LINES[i % 12] + "\n" for i in range(N)).encode(), ["12 different places"], None
    yield "tiny", ply(kind="double") + b"".join(struct.pack("<6d", *(1e-60 * v for v in r)) for r in ROWS), ["1e-50"]
    yield "huge", ply(kind="double") + b"".join(struct.pack("<6d", *(1e60 * v for v in r)) for r in ROWS), ["1e50"]
    yield "few_announced", ply(count=50) + binary(), ["after the last item"]
    yield "long_row", ply("ascii") + with_line(2, "1 2 3 4 5 6 7").encode(), ["line 13", "too many"]
    for label in ("1.5", "nan", "3000000000"):
        yield f"label_{label}", (ply("ascii", more="property float label\n") +
                                 labelled(lambda i: label if i == 4 else 1)), ["point 5", "label"]
    yield "one_place", ply("ascii") + (N * "1 2 3 0 0 1\n").encode(), ["1 different places"]
    rgb, many = "".join(f"property uchar {c}\n" for c in ("red", "green", "blue")), 3000
    rows = [struct.pack("<6f", *row) for row in ROWS]
    yield "fields_many", (ply(more=rgb + "".join(f"property uchar f{i}\n" for i in range(many))) +
                          b"".join(row + bytes(3 + many) for row in rows)), None
    yield "fields_cut", ply(more=rgb + "property double t\n") + 99 * bytes(35), ["100 x vertex", "cut short"]
    for count in ("4000000000", "18446744073709551615"):
        yield f"fields_{count}", ply(count=count, more=rgb + "property double t\n") + binary(), [count, "cut short"]
    wild = ("1e308 -1e308 nan 1e308 0", "inf -inf 1e300 -inf 0", "-1 256 1e-320 nan 0")
    yield "fields_wild", (ply("ascii", more="".join(f"property double {c}\n" for c in ("red", "green", "blue", "t", "t"))) +
                          labelled(lambda i: wild[i % 3])), None
    yield "fields_word", ply("ascii", more="property float t\n") + labelled(lambda i: "hot"), ["line 12", "'hot'"]
    yield "fields_names", (ply("ascii", more="property float \xff<x>\nproperty float normal@x\nproperty float x/y\n") +
                           labelled(lambda i: "1 2 3")), None


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
    yield "points_4e9_ascii", pcd("ascii", width="4000000000", points="4000000000") + TEXT.encode(), ["100 of 4000000000"]
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
    yield "points_1e18", pcd(width=1, points=10 ** 18) + binary(), ["POINTS"]
    yield "no_points", pcd(width=0, points=0), ["0 points"]
    yield "no_points_packed", pcd("binary_compressed", width=0, points=0) + bytes(8), ["0 points"]
    yield "only_padding", (b"FIELDS _\nSIZE 4\nTYPE F\nWIDTH 1\nHEIGHT 1\nPOINTS 1\nDATA binary_compressed\n12345678"), \
        ["no fields"]
    yield "no_normals", pcd().replace(b"normal_x normal_y normal_z", b"a b c") + binary(), None, ["no normals"]
    yield "empty", b"", ["empty"]
    yield "no_fields", pcd().replace(b"FIELDS x y z normal_x normal_y normal_z\n", b"") + binary(), ["FIELDS"]
    yield "bare_data", b"VERSION .7\nDATA\n", ["FIELDS"]
    def more(data, names, sizes, types, counts, **head):
        lines = pcd(data, **head).decode().split("\n")
        return "\n".join(line + {"FIELDS": f" {names}", "SIZE": f" {sizes}", "TYPE": f" {types}",
                                 "COUNT": f" {counts}"}.get(line.split(" ")[0], "") for line in lines).encode()
    nan = b"".join(struct.pack("<6fI", *row, 0xffffffff) for row in ROWS)
    yield "rgb", more("binary", "rgb", 4, "F", 1) + nan, None
    yield "rgb_points_4e9", more("binary", "rgb", 4, "F", 1, width="4000000000", points="4000000000") + nan, ["4000000000"]
    yield "rgb_of_8_bytes", more("ascii", "rgb", 8, "F", 1) + labelled(lambda i: "1e300"), None
    yield "rgb_wild", (more("ascii", "rgb t", "4 8", "F F", "1 1") +
                       labelled(lambda i: ("nan inf", "-1e300 1e999", "hot 4294967296", "-nan -0")[i % 4])), None
    yield "field_count_2e9", more("binary", "t", 8, "F", "2000000000") + nan, ["COUNT 2000000000"]
    yield "data_unknown", pcd("binary_zipped") + binary(), ["binary_zipped"]
    yield "data_missing", pcd()[:pcd().index(b"DATA")], ["DATA"]
    yield "random", random.Random(2).randbytes(5000), ["line 1"]


def labelled(label):
    return "".join(f"{line} {label(i)}\n" for i, line in enumerate(LINES)).encode()


def flat(point):
    """Forty points with normals along z."""
    return "".join(" ".join(map(str, point(i))) + " 0 0 1\n" for i in range(40)).encode()


def xyz_cases():
    bare = "".join(" ".join(line.split()[:3]) + "\n" for line in LINES)
    yield "six", TEXT.encode(), None
    yield "three", bare.encode(), None, ["line 1", "no normals"]
    yield "empty", b"", ["empty"]
    yield "two_columns", b"1 2\n" * N, ["line 1"]
    yield "two_lines", b"1 2\n3 4\n", ["line 1"]
    yield "one_point", b"1 2 3\n", ["1 points"], ["line 1", "no normals"]
    yield "eight_columns", b"# head\n" + labelled(lambda i: "7 8.5"), None
    yield "unknown_vectors", "".join(f"{line} {3 * i} {-1.5 * i} {i % 7}\n" for i, line in enumerate(bare.splitlines())).encode(), \
        ["line 1", "columns 4 to 6", "give ", "x,y,z,nx,ny,nz"]
    yield "many_scalars", labelled(lambda i: f"{i} {-2 * i} {i * i} {7 - i}"), ["line 1", "columns 7 to 10", "give "]
    yield "nine_points", ("\n".join(LINES[:9]) + "\n").encode(), ["9 points", "30"], ["9 points", "10"]
    yield "ragged", with_line(6, "1 2 3").encode(), ["line 7"]
    yield "three_then_six", (bare + TEXT).encode(), ["line 101"], ["line 1"]
    yield "mostly_bad", (bare + 101 * "nan 0 0\n").encode(), ["101 of 201"], ["line 1"]
    yield "word", ("x y z\n" + TEXT).encode(), ["line 1", "3 names", "line 2", "6 columns", "to name them"]
    yield "six_words", ("x y z nx ny nz\n" + TEXT).encode(), None
    yield "commas", TEXT.replace(".", ",").encode(), None
    yield "commas_three", b"0,1 0,2 0,3\n", ["1 points"], ["line 1", "no normals"]  # six columns if commas separated
    yield "semicolons", b"0,1;0,2;0,3;0,0;0,0;1,0\n", ["1 points"], ["line 1", "no normals"]
    yield "commas_of_both", TEXT.replace(".", ",").encode() + b"1.5 2,5 3 0 0 1\n", ["line 101, column 1", "'1.5'"]
    yield "overflow", with_line(6, "1e999 0 0 0 0 1").encode(), ["line 7"]
    yield "infinite", with_line(6, "inf 0 0 0 0 1").replace(LINES[9], "0 nan 0 0 0 1").encode(), None, ["point 7 ", "2 such"]
    yield "beyond", with_line(6, "1e51 0 0 0 0 1").encode(), None, ["point 7 ", "1e50"]
    yield "zero_normal", with_line(6, "0 0 0 0 -0 0").encode(), None, ["point 7 ", "zero normal"]
    yield "one_long_line", b"1 " * 500000, ["line 1"]
    yield "long_last_line", TEXT.encode() + (1 << 17) * b"1", ["line 101: 131072 bytes long"]
    yield "nul", bytes(5000), ["line 1"]
    yield "random", random.Random(3).randbytes(5000), ["line 1"]
    yield "hundred_labels", labelled(lambda i: i), None
    yield "colours", "".join(line + " 12 200 17 3\n" for line in bare.splitlines()).encode(), None, ["no normals"]
    yield "named", b"//X Y Z Nx Ny Nz R G B Heat\n" + labelled(lambda i: "1 2 999 -7.5"), None
    yield "named_twice", b"# x y z x y z\n" + TEXT.encode(), ["column x more than once"]
    yield "names_without_end", b"# x y z " + 30000 * b"t " + b"\n" + TEXT.encode(), None
    yield "one_place", flat(lambda i: (1, 2, 3)), ["1 different places"], ["no normals"]
    yield "corners", flat(lambda i: (i & 1, i >> 1 & 1, i >> 2 & 1)), ["8 different places"], ["no normals"]
    yield "line", flat(lambda i: (i, 2 * i, 5)), ["one line"], ["no normals"]
    yield "plane", flat(lambda i: (i % 7, i // 7, i % 7 + i // 7)), ["one plane"], ["no normals"]
    yield "tiny", "".join(" ".join(repr(v if k > 2 else 1e-52 * v) for k, v in enumerate(r)) + "\n" for r in ROWS).encode(), \
        ["1e-50"]


    yield "utf16", b"\xff\xfe" + TEXT.encode("utf-16-le"), ["line 1", "UTF-8"]
    yield "latin1", "# größe\n".encode("latin-1") + TEXT.encode(), None
    yield "hundred_headers", 100 * b"some words\n" + TEXT.encode(), ["line 1", "no row of three"]
    yield "only_comments", 1000 * b"# 1 2 3\n", ["line 1", "no row of three"]
    yield "only_header", b"x y z\n", ["line 1", "no row of three"]
    yield "control", TEXT.replace(" ", "\x01", 1).encode(), ["line 1"]
    yield "half_a_number", TEXT.encode() + b"1 2 3 0 0 1e\n", ["line 101, column 6", "'1e'"]
    yield "half_a_row", TEXT.encode()[:-60], ["line 100", "cut short"]
    yield "json", b'{"points": [[1, 2, 3], [4, 5, 6]]}\n', ["line 1"]
    yield "html", b"<!DOCTYPE html>\n<html><body>404</body></html>\n", ["line 1", "no row of three"]
    yield "deep_quotes", 5000 * b'"' + b"\n" + TEXT.encode(), None
    yield "wild", labelled(lambda i: ("nan inf", "-inf 1e308", "1e-320 -0", "NA null")[i % 4]), None
    yield "old_mac", TEXT.replace("\n", "\r").encode(), None
    yield "chemistry", b"100\na molecule\n" + "".join("C " + line + "\n" for line in bare.splitlines()).encode(), None, ["no normals"]


def csv_cases():
    table = TEXT.replace(" ", ",")
    yield "table", b"x,y,z,nx,ny,nz\n" + table.encode(), None
    yield "empty_names", b",,,,,\n" + table.encode(), None
    yield "empty_fields", 1000 * b",,,,,\n", ["line 1", "no row of three"]
    yield "no_coordinates", b"x,y,z,nx,ny,nz\n1,2,3,0,0,1\n" + 200 * b",,,0,0,1\n", ["200 of 201"], ["point 2 "]
    yield "trailing", b"x;y;z;\n" + "".join(";".join(line.split()[:3]) + ";\n" for line in LINES).encode(), None, ["no normals"]
    yield "ragged", table.encode() + b"1,2,3,,0,1,\n1,2,3,4,5,6,7\n", ["line 102", "7 columns"]
    yield "no_axes", b"a,b,c,d,e,f\n" + table.encode(), None
    yield "words", "".join(f"{line},hot\n" for line in table.splitlines()).encode(), None
    yield "word_in_row", table.encode() + b"1,2,zero,0,0,1\n", ["line 101, column 3", "'zero'"]
    yield "commas", TEXT.replace(".", ",").replace(" ", ";").encode(), None
    yield "rgb_twice", b"x,y,z,r,g,b,red\n" + "".join(",".join(line.split()[:3]) + ",1,2,3,4\n" for line in LINES).encode(), None, ["no normals"]


def asc_cases():
    yield "six", TEXT.encode(), None
    yield "esri_grid", b"ncols 4\nnrows 6\nxllcorner 0.0\ncellsize 50\n-9999 -9999 5 2\n", ["line 1", "grid of heights", "gdal_translate"]


def pts_cases():
    yield "counted", ("101\n" + TEXT).encode(), ["101", "100"]
    yield "leica", b"100\n" + labelled(lambda i: 1), None
    yield "two_scans", b"100\n" + TEXT.encode() + b"100\n" + TEXT.encode(), None
    yield "second_cut", b"100\n" + TEXT.encode() + b"7\n" + TEXT.encode()[:300], ["cut short"]
    yield "second_count", b"100\n" + TEXT.encode() + b"18446744073709551615\n1 2 3 0 0 1\n", ["line 102", "18446744073709551615"]
    yield "count_wraps", b"18446744073709551615\n" + TEXT.encode(), ["18446744073709551615", "100"]
    yield "only_count", b"100\n", ["no row of three"]


def las_cases():
    yield "cloud", TEXT.encode(), ["LAS", "pdal translate"]
    yield "header", b"LASF" + bytes(371), ["LAS", "CloudCompare"]


def e57_cases():
    yield "header", b"ASTM-E57" + bytes(40), ["E57", "CloudCompare"]


def unknown_cases():
    yield "cloud", TEXT.encode(), None
    yield "words", b"a list of points\n" + TEXT.encode(), ["none of .xyz"]
    yield "comments", b"# a list of points\n" + TEXT.encode(), None
    yield "mesh", b"*NODE\n1, 0., 0., 0.\n2, 1., 0., 0.\n", ["none of .xyz"]
    yield "las", b"LASF" + bytes(371), ["LAS", "pdal translate"]


def msh_cases():
    head = b"$MeshFormat\n2.2 0 8\n$EndMeshFormat\n"
    yield "empty", b"", ["no $MeshFormat"]
    yield "huge", head + b"$Nodes\n4000000000\n", ["more than the file can hold"]
    yield "negative", head + b"$Nodes\n-5\n", ["not a number"]
    yield "word", head + b"$Nodes\n1\n1 0 zero 0\n", ["line 6"]
    yield "version", b"$MeshFormat\n4 0 8\n$EndMeshFormat\n", ["only 2.2 and 4.1"]
    tet = b"$EndNodes\n$Elements\n1\n1 4 2 0 0 1 %s\n$EndElements\n"
    yield "missing", head + b"$Nodes\n1\n1 0 0 0\n" + tet % b"2 3 4", ["node 2 does not exist"]
    yield "twice", head + b"$Nodes\n2\n1 0 0 0\n1 0 0 0\n" + tet % b"1 1 1", ["given twice"]


def mesh_cases():
    head = b"MeshVersionFormatted 2\nDimension 3\n"
    yield "empty", b"", ["empty"]
    yield "huge", head + b"Vertices\n123456789012\n", ["more than the file can hold"]
    yield "flat", b"MeshVersionFormatted 2\nDimension 2\n", ["must be 3"]
    yield "none", head + b"Vertices\n1\n0 0 0 0\nEnd\n", ["no tets"]
    nodes = b"Vertices\n5\n9 9 nan 0\n0 0 0 0\n1 0 0 0\n0 %s 0 0\n0 0 1 0\nTetrahedra\n1\n2 3 4 %s 1\nEnd\n"
    yield "unused_nan", head + nodes % (b"1", b"5"), None  # node 1 is no number, but in no tet
    yield "node_twice", head + nodes % (b"1", b"4"), ["tet 1: it has its node 4 twice"]
    yield "no_place", head + nodes % (b"inf", b"5"), ["node 4: a coordinate is not"]


def inp_cases():
    nodes = b"*NODE\n1, 9, 9, nan\n2, 0, 0, 0\n3, 1, 0, 0\n4, 0, %s, 0\n5, 0, 0, 1\n"
    tet = b"*ELEMENT, TYPE=C3D4, ELSET=a\n"
    yield "empty", b"", ["no tets"]
    yield "numbers", b"1, 2, 3\n", ["no keyword"]
    yield "none", nodes % b"1", ["no tets"]
    yield "shells", nodes % b"1" + b"*ELEMENT, TYPE=S3\n1, 2, 3, 4\n", ["no tets"]
    yield "unused_nan", nodes % b"1" + tet + b"1, 2, 3, 4, 5\n", None  # node 1 is no number, but in no tet
    yield "no_place", nodes % b"inf" + tet + b"1, 2, 3, 4, 5\n", ["node 4: a coordinate is not"]
    yield "no_number", nodes % b"one" + tet + b"1, 2, 3, 4, 5\n", ["node coordinate: not a number"]
    yield "node_twice", nodes % b"1" + tet + b"1, 2, 3, 4, 4\n", ["tet 1: it has its node 4 twice"]
    yield "no_node", nodes % b"1" + tet + b"1, 2, 3, 4, 9\n", ["its node 9 does not exist"]
    yield "short", nodes % b"1" + tet + b"1, 2, 3, 4\n", ["ends in an element"]
    yield "short_before", nodes % b"1" + tet + b"1, 2, 3, 4\n*STEP\n", ["without all of its nodes"]
    yield "long", nodes % b"1" + tet + b"1, 2, 3, 4, 5, 2\n", ["more nodes"]
    yield "parts", b"*PART, NAME=a\n*PART, NAME=b\n", ["a second *PART"]
    yield "same_numbers", nodes % b"1" + nodes % b"1" + tet + b"1, 2, 3, 4, 5\n", ["node 1 is given twice"]
    far = b"*ELSET, ELSET=b, GENERATE\n-9223372036854775808, 9223372036854775807, 9223372036854775807\n"
    yield "far", nodes % b"1" + tet + b"1, 2, 3, 4, 5\n" + far, None


def vtu_cases():
    grid = b"<VTKFile type=\"UnstructuredGrid\"><UnstructuredGrid>"
    yield "empty", b"", ["not a VTK XML file"]
    yield "huge", (grid + b"<Piece NumberOfPoints=\"4000000000\" NumberOfCells=\"1\"></Piece></UnstructuredGrid></VTKFile>"), \
        ["more than the file can hold"]
    yield "nest", grid + b"</VTKFile>", ["do not nest"]
    yield "other", b"<VTKFile type=\"PolyData\"></VTKFile>", ["UnstructuredGrid"]
    raw = (STORED / "mesh_vtu/appended_raw.vtu").read_bytes()
    yield "no_appended_data", raw[:raw.index(b"<AppendedData")] + b"</VTKFile>", ["no appended data"]
    yield "types_missing", raw.replace(b"types", b"kinds"), ["no cell types"]
    yield "offsets_missing", raw.replace(b'"offsets"', b'"onsets"'), ["offsets missing"]
    # What a parser of XML sees otherwise than a search for letters would.
    for name, before, after, words in (
            ("offset_in_note", b'offset="96"', b"Note=\"a offset='96'\" offset=\"97\"", ["more parts than bytes"]),
            ("offset_as_reference", b'offset="96"', b'offset="&#57;7"', ["references to characters"]),
            ("tag_in_attribute", b"<Cells>", b'<Cells a="b>">', ["attributes"]),
            ("data_in_comment", b"<Cells>", b'<!-- <AppendedData encoding="raw"> --><Cells>', ["in a comment"]),
            ("data_in_instruction", b"<Cells>", b"<?x ><AppendedData>_?><Cells>", ["in a comment"])):
        assert before in raw
        yield name, raw.replace(before, after, 1), words


# A ball in 7 x 6 x 8 nodes.
GRID_N = (7, 6, 8)
GRID = [math.dist((i, j, k), (3, 2.5, 3.5)) - 2 for k in range(8) for j in range(6) for i in range(7)]
FLOATS, DOUBLES = struct.pack(f"<{len(GRID)}f", *GRID), struct.pack(f"<{len(GRID)}d", *GRID)
MASK = bytes(v < 0 for v in GRID)


def nrrd(data=FLOATS, **fields):
    head = {"type": "float", "dimension": 3, "sizes": "7 6 8", "encoding": "raw", "endian": "little", "spacings": ".1 .1 .2"}
    head.update({name.replace("_", " "): value for name, value in fields.items()})
    lines = "".join(f"{name}: {value}\n" for name, value in head.items() if value is not None)
    return b"NRRD0004\n# a ball\n" + lines.encode() + b"\n" + data


def nrrd_cases():
    text = " ".join(map(repr, GRID)).encode()
    yield "raw", nrrd(), None
    yield "ascii", nrrd(text, encoding="ascii"), None
    yield "gzip", nrrd(gzip.compress(FLOATS, mtime=0), encoding="gzip"), None
    yield "whole_gzip", gzip.compress(nrrd(), mtime=0), None
    yield "directions", nrrd(spacings=None, space_directions="(0,.1,0) (.1,0,0) (0,0,.2)", space_origin="(1,2,3)"), None
    yield "mask", nrrd(MASK, type="unsigned char", endian=None), None
    yield "empty", b"", ["neither VTK"]
    yield "cut", nrrd()[:600], ["no room"]
    yield "gzip_cut", nrrd(gzip.compress(FLOATS, mtime=0)[:200], encoding="gzip"), ["the file is cut"]
    yield "gzip_damaged", nrrd(gzip.compress(FLOATS, mtime=0)[:99] + 300 * b"x", encoding="gzip"), ["gzip"]
    yield "no_gzip", nrrd(encoding="gzip"), ["said to be of gzip"]
    yield "head_cut", b"NRRD0004\ntype: float\n", ["the file is cut"]
    yield "sizes_2e9", nrrd(sizes="2000000000 2000000000 2"), ["no room"]
    yield "sizes_negative", nrrd(sizes="-7 6 8"), ["a number of nodes that is none"]
    yield "sizes_wrap", nrrd(sizes="4294967296 4294967296 1"), ["a number of nodes that is none"]
    yield "sizes_word", nrrd(sizes="7 six 8"), ["'six' is not a whole number"]
    yield "sizes_two", nrrd(sizes="7 6"), ["sizes: three"]
    yield "dimension", nrrd(dimension=4), ["dimension: 3"]
    yield "type", nrrd(type="block"), ["'block'"]
    yield "no_type", nrrd(type=None), ["'type' is missing"]
    yield "encoding", nrrd(encoding="bzip2"), ["'bzip2'"]
    yield "detached", nrrd(data_file="../../../../etc/passwd"), ["'data file' is not read"]
    yield "endian", nrrd(endian="middle"), ["endian"]
    yield "no_line", nrrd(b"", type=None).replace(b"dimension:", b"dimension"), ["FIELD: VALUE"]
    yield "vector", nrrd(space_directions="(0,.1) (.1,0,0) (0,0,.2)"), ["three numbers"]
    yield "flat", nrrd(space_directions="(0,.1,0) (0,.1,0) (0,0,.2)"), ["span space"]
    yield "spacing_nan", nrrd(spacings="nan 1 1"), ["span space"]
    yield "few", nrrd(sizes="7 6 1"), ["7 x 6 x 1", "at least 6"]
    yield "nan", nrrd(struct.pack("<f", math.nan) + FLOATS[4:]), ["value (0, 0, 0) is not finite"]
    yield "word", nrrd(b"a" + text, encoding="ascii"), ["is not a number"]
    yield "words_cut", nrrd(text[:500], encoding="ascii"), ["no room"]


def nifti(data=FLOATS, dim=(3, 7, 6, 8, 1, 1, 1, 1), datatype=16, offset=352., slope=0., sform=1, qform=0, magic=b"n+1\0", order="<",
          row=(.1, 0, 0, -1)):
    head = bytearray(348)
    struct.pack_into(order + "i", head, 0, 348)
    struct.pack_into(order + "8h", head, 40, *dim)
    struct.pack_into(order + "hh", head, 70, datatype, 32)
    struct.pack_into(order + "8f", head, 76, 1, .1, .1, .2, 0, 0, 0, 0)
    struct.pack_into(order + "fff", head, 108, offset, slope, 0)
    struct.pack_into(order + "hh", head, 252, qform, sform)
    struct.pack_into(order + "6f", head, 256, 0, 0, .7071068, 1, 2, 3)
    struct.pack_into(order + "12f", head, 280, *row, 0, .1, 0, -1, 0, 0, .2, -1)
    head[344:348] = magic
    return bytes(head) + bytes(4) + data


def nifti_cases():
    yield "sform", nifti(), None
    yield "qform", nifti(sform=0, qform=1), None
    yield "sizes", nifti(sform=0), None
    yield "big", nifti(struct.pack(f">{len(GRID)}f", *GRID), order=">"), None
    yield "scaled", nifti(slope=2.), None
    yield "mask", nifti(MASK, datatype=2), None
    yield "gzip", gzip.compress(nifti(), mtime=0), None
    yield "head_cut", nifti()[:300], ["neither VTK"]
    yield "cut", nifti()[:900], ["no room"]
    yield "gzip_cut", gzip.compress(nifti(), mtime=0)[:-100], ["the file is cut"]
    yield "pair", nifti(magic=b"ni1\0"), [".hdr and .img"]
    yield "second", b"\x1c\x02\0\0n+2\0" + bytes(600), ["NIfTI-2"]
    yield "dim", nifti(dim=(2, 7, 6, 1, 1, 1, 1, 1)), ["2 dimensions"]
    yield "dim_negative", nifti(dim=(3, -7, 6, 8, 1, 1, 1, 1)), ["a number of nodes that is none"]
    yield "dim_huge", nifti(dim=(3, 32767, 32767, 32767, 1, 1, 1, 1)), ["no room"]
    yield "times", nifti(dim=(4, 7, 6, 8, 9, 1, 1, 1)), ["more than one number a voxel"]
    yield "type", nifti(datatype=128), ["data type 128"]
    yield "offset", nifti(offset=12.), ["vox_offset"]
    yield "offset_nan", nifti(offset=math.nan), ["vox_offset"]
    yield "offset_far", nifti(offset=1e8), ["the file is cut"]
    yield "flat", nifti(row=(0, .1, 0, 0)), ["span space"]


def vtk(data=None, form="BINARY", dimensions="7 6 8", more="SCALARS psi float 1\nLOOKUP_TABLE default\n", of="POINT_DATA 336"):
    if data is None:
        data = struct.pack(f">{len(GRID)}f", *GRID)
    return (f"# vtk DataFile Version 3.0\na ball\n{form}\nDATASET STRUCTURED_POINTS\nDIMENSIONS {dimensions}\nSPACING .1 .1 .2\n"
            f"ORIGIN 0 0 0\n{of}\n{more}").encode() + data


def vtk_cases():
    text = "\n".join(map(repr, GRID)).encode()
    yield "binary", vtk(), None
    yield "ascii", vtk(text, "ASCII"), None
    yield "field", vtk(more="FIELD FieldData 1\npsi 1 336 float\n"), None
    yield "cells", vtk(of="CELL_DATA 336", dimensions="8 7 9"), None
    yield "gzip", gzip.compress(vtk(), mtime=0), None
    yield "head_cut", vtk()[:80], ["the file is cut"]
    yield "cut", vtk()[:900], ["no room"]
    yield "text_cut", vtk(text[:2000], "ASCII"), ["the file is cut"]
    yield "form", vtk(form="TERNARY"), ["'TERNARY'"]
    yield "dataset", vtk().replace(b"STRUCTURED_POINTS", b"POLYDATA"), ["STRUCTURED_POINTS"]
    yield "dimensions", vtk(dimensions="7 6"), ["a line that is cut"]
    yield "dimensions_huge", vtk(dimensions="2000000000 2000000000 2000000000"), ["no room"]
    yield "no_dimensions", vtk().replace(b"DIMENSIONS", b"MEASURES"), ["DIMENSIONS are missing"]
    yield "vectors", vtk(more="SCALARS psi float 3\nLOOKUP_TABLE default\n"), ["one number a node"]
    yield "table", vtk(text, "ASCII", more="SCALARS psi float 1\n"), ["LOOKUP_TABLE"]
    yield "type", vtk(more="SCALARS psi quad 1\nLOOKUP_TABLE default\n"), ["'quad'"]
    yield "no_numbers", vtk(b"\n" * 2000, more=""), ["no numbers"]
    yield "endless_line", vtk(b"1" * 100000, more=""), ["more than 65536 bytes"]
    yield "word", vtk(b"inf one " + text, "ASCII"), ["'one' is not a number"]
    yield "infinite", vtk(b"inf " + text, "ASCII"), ["not finite"]


def image(array='type="Float64" format="appended" offset="0"', inline="", appended=None, compressor="", extent="0 6 0 5 0 7",
          of="PointData", encoding="raw", more=""):
    if appended is None:
        appended = struct.pack("<Q", len(DOUBLES)) + DOUBLES
    return (f'<?xml version="1.0"?>\n<VTKFile type="ImageData" version="1.0" byte_order="LittleEndian" header_type="UInt64"{compressor}>\n'
            f'<ImageData WholeExtent="{extent}" Origin="0 0 0" Spacing=".1 .1 .2">\n<Piece Extent="{extent}">\n<{of} Scalars="psi">\n{more}'
            f'<DataArray Name="psi" {array}>{inline}</DataArray>\n</{of}>\n</Piece>\n</ImageData>\n<AppendedData encoding="{encoding}">\n_'
            ).encode() + appended + b"\n</AppendedData>\n</VTKFile>\n"


def packed(piece=1000):
    """Blocks of zlib."""
    blocks = [zlib.compress(DOUBLES[at:at + piece]) for at in range(0, len(DOUBLES), piece)]
    head = struct.pack(f"<{3 + len(blocks)}Q", len(blocks), piece, len(DOUBLES) % piece, *map(len, blocks))
    return head, b"".join(blocks)


def image_cases():
    zlib_ = ' compressor="vtkZLibDataCompressor"'
    head, blocks = packed()
    of_64 = base64.b64encode(struct.pack("<Q", len(DOUBLES)) + DOUBLES).decode()
    packed_64 = base64.b64encode(head) + base64.b64encode(blocks)
    yield "raw", image(), None
    yield "ascii", image('type="Float32" format="ascii"', " ".join(map(repr, GRID))), None
    yield "base64", image('type="Float64" format="binary"', "\n" + of_64 + "\n"), None
    yield "appended_base64", image(appended=of_64.encode(), encoding="base64"), None
    yield "packed", image(appended=head + blocks, compressor=zlib_), None
    yield "packed_base64", image(appended=packed_64, compressor=zlib_, encoding="base64"), None
    yield "cells", image(extent="0 7 0 6 0 8", of="CellData"), None
    yield "second", image(more='<DataArray type="Float32" Name="n" NumberOfComponents="3" format="ascii">1 2 3</DataArray>\n'), None
    yield "gzip", gzip.compress(image(), mtime=0), None
    yield "other", b'<VTKFile type="PolyData"></VTKFile>', ["'PolyData'"]
    yield "no_array", image().replace(b"DataArray", b"Array"), ["no array"]
    yield "cut", image()[:1500], ["no room"]
    yield "packed_cut", image(appended=(head + blocks)[:900], compressor=zlib_)[:-40], ["the file is cut"]
    yield "packed_damaged", image(appended=head + bytes(len(blocks)), compressor=zlib_), ["damaged zlib"]
    yield "packed_lies", image(appended=struct.pack("<4Q", 1, 1 << 40, 0, 10), compressor=zlib_), ["not as long as its nodes"]
    yield "packed_huge", image(appended=struct.pack("<4Q", 2 ** 63, 2 ** 63, 0, 10), compressor=zlib_), ["a count that is none"]
    yield "lzma", image(compressor=' compressor="vtkLZMADataCompressor"'), ["'vtkLZMADataCompressor'"]
    yield "lz4", image(compressor=' compressor="vtkLZ4DataCompressor"'), ["a count that is none"]
    yield "count", image(appended=struct.pack("<Q", 1 << 60) + DOUBLES), ["a count that is none"]
    yield "count_less", image(appended=struct.pack("<Q", 80) + DOUBLES), ["not as long as its nodes"]
    yield "offset_far", image('type="Float64" format="appended" offset="999999999"'), ["the file is cut"]
    yield "offset_negative", image('type="Float64" format="appended" offset="-8"'), ["offset"]
    yield "extent_huge", image(extent="0 999999999 0 999999999 0 999999999"), ["no room"]
    yield "extent_negative", image(extent="0 -5 0 5 0 5"), ["extent"]
    yield "extent_cut", image(extent="0 5 0 5"), ["six numbers"]
    yield "type", image('type="Float16" format="ascii"'), ["'Float16'"]
    yield "format", image('type="Float32" format="morse"'), ["'morse'"]
    yield "no_base64", image('type="Float64" format="binary"', "?" * 8000), ["not base64"]
    yield "tag", b'<VTKFile type="ImageData" what>' + bytes(50), ["a tag that cannot be read"]
    yield "endless_tag", b"<VTKFile " + b"x" * 100000, ["more than 65536 bytes"]


def other_cases():
    yield "what", b"solid", ["unknown extension"]


# Eight corners and the two triangles of each side of a cube; read_triangles() may accept what bounds no body.
CORNERS = [(i, j, k) for i in (0, 1) for j in (0, 1) for k in (0, 1)]
QUADS = [(0, 1, 3, 2), (4, 6, 7, 5), (0, 4, 5, 1), (2, 3, 7, 6), (0, 2, 6, 4), (1, 5, 7, 3)]
TRIANGLES = [t for a, b, c, d in QUADS for t in ((a, b, c), (a, c, d))]


def stl_facet(a, b, c):
    lines = "".join(f"vertex {' '.join(map(str, x))}\n" for x in (a, b, c))
    return f"facet normal 0 0 0\nouter loop\n{lines}endloop\nendfacet\n"


def stl_text(triangles=TRIANGLES, name="cube"):
    return f"solid {name}\n" + "".join(stl_facet(*(CORNERS[v] for v in t)) for t in triangles) + f"endsolid {name}\n"


def stl_binary(count=12, begin=b""):
    records = b"".join(struct.pack("<12fH", 0, 0, 0, *(c for v in t for c in CORNERS[v]), 0) for t in TRIANGLES)
    return begin.ljust(80, b"\0") + struct.pack("<I", count) + records


def stl_cases():
    text, binary = stl_text(), stl_binary()
    yield "ascii", text.encode(), None
    yield "binary", binary, None
    yield "binary_solid", stl_binary(begin=b"solid by an exporter"), None
    yield "two_solids", (stl_text() + stl_text(name="again")).encode(), None
    yield "upper_case", text.upper().encode(), None
    yield "no_bytes", b"", ["empty"]
    yield "binary_cut", binary[:300], ["byte 80", "12 triangles", "cut short"]
    yield "header_cut", binary[:60], ["60 bytes"]
    yield "header_only", binary[:80], ["80 bytes"]
    for count in (13, 1 << 31, (1 << 32) - 1):
        yield f"count_{count}", stl_binary(count), [f"{count} triangles", "600 bytes follow"]
    yield "count_0", stl_binary(0), ["0 triangles"]
    yield "count_11", stl_binary(11), ["after the last item"]
    for name, number in (("nan", "nan"), ("inf", "-inf"), ("far", "1e60")):
        yield name, text.replace("vertex 0 0 1", f"vertex 0 {number} 1", 1).encode(), ["face 1 of 12", "NaN"]
    yield "nan_binary", binary[:96] + struct.pack("<f", math.nan) + binary[100:], ["face 1 of 12", "NaN"]
    yield "word", text.replace("vertex 0 0 1", "vertex 0 zero 1", 1).encode(), ["line 5", "'zero'"]
    yield "commas", text.replace("vertex 0 0 1", "vertex 0,5 0 1", 1).encode(), ["line 5", "decimal comma"]
    yield "two_numbers", text.replace("vertex 0 0 1", "vertex 0 0", 1).encode(), ["line 5", "2 values"]
    yield "two_corners", text.replace("vertex 0 0 1\n", "", 1).encode(), ["line 6", "2 vertices"]
    yield "ascii_cut", text[:text.index("facet normal", 700)].encode(), ["cut short"]
    yield "cut_in_word", text[:700].encode(), ["line "]
    yield "no_end", text.replace("endsolid cube\n", "").encode(), ["before 'endsolid'"]
    yield "no_loop", text.replace("outer loop\n", "", 1).encode(), ["line 3", "'outer loop'"]
    yield "trailing", (text + "what\n").encode(), ["'what'", "'solid'"]
    yield "no_facets", b"solid nothing\nendsolid\n", ["no faces"]
    yield "one_facet", stl_text(TRIANGLES[:1]).encode(), ["3 different places"]
    yield "flat", stl_text(TRIANGLES[:2]).encode(), ["one plane"]
    yield "one_place", ("solid\n" + 9 * stl_facet((1, 2, 3), (1, 2, 3), (1, 2, 3)) + "endsolid\n").encode(), ["1 different places"]
    # Corners in three dimensions, but no triangle has an area.
    yield "no_area", ("solid\n" + "".join(stl_facet(x, x, y) for x in CORNERS for y in CORNERS) + "endsolid\n").encode(), \
        ["no triangle has an area"], None
    yield "random", random.Random(5).randbytes(5000), ["byte 80"]
    yield "random_text", b"solid " + random.Random(6).randbytes(5000), ["line "]
    yield "zeros", bytes(5000), ["0 triangles"]
    yield "long_line", b"solid " + (1 << 17) * b"a", ["line 1", "'endsolid'"]


def obj_text(vertices=CORNERS, faces=TRIANGLES, more=""):
    return ("".join(f"v {x} {y} {z}\n" for x, y, z in vertices) + more +
            "".join(f"f {' '.join(str(v + 1) for v in f)}\n" for f in faces)).encode()


def feat_cases():
    good = "feat 2\n# two edges\n3\n0 0 0\n0 0 1\n0 1 1\n\n2\n1 0 0\n1 1 0\n"
    yield "edges", good.encode(), None
    yield "crlf", good.replace("\n", "\r\n").encode(), None
    yield "repeated", ("feat 3\n" + good[7:] + "2\n1 1 0\n1 0 0\n").encode(), None
    yield "subdivided", good.replace("0 0 1\n", "0 0 .25\n0 0 1\n").replace("\n3\n", "\n4\n").encode(), None
    yield "cut", good[:-6].encode(), ["line 9", "polyline 2 of 2", "cut short"]
    yield "no_polyline", b"feat 0\n", ["no line of two points"]
    yield "point", b"feat 1\n1\n0 0 0\n", ["no line of two points"]
    yield "word_only", b"feat", ["number of polylines", "cut short"]
    for count in ("18446744073709551615", "4000000000"):
        yield f"count_{count}", good.replace("feat 2", "feat " + count).encode(), ["polyline 3 of " + count, "cut short"]
        yield f"points_{count}", good.replace("\n3\n", f"\n{count}\n").encode(), ["line 8", "point 4 of " + count]
    yield "negative", good.replace("\n3\n", "\n-3\n").encode(), ["line 3", "'-3'"]
    yield "trailing", (good + "1\n").encode(), ["line 11", "2 polylines"]
    yield "word", good.replace("0 0 1", "0 zero 1").encode(), ["line 5", "'zero'"]
    yield "commas", good.replace("0 0 1", "0 0,5 1").encode(), ["line 5", "decimal comma"]
    yield "nan", good.replace("0 0 1", "0 nan 1").encode(), ["line 5", "NaN"]
    yield "huge_number", good.replace("0 0 1", "0 1e60 1").encode(), ["line 5", "1e50"]
    yield "far", good.replace("0 0 1", "0 0 3").encode(), ["line 5", "2 from the triangles"]
    yield "through", good.replace("1 1 0", "0 1 1").encode(), ["no edge of the triangles"]
    yield "in_a_side", good.replace("1 1 0", "1 .5 .3").encode(), ["line 10", "a line ends there"]
    yield "binary", b"feat 1\n" + random.Random(7).randbytes(5000), ["line "]


def emesh_cases():
    head = "FoamFile\n{\n    version 2.0;\n    format ascii;\n    class featureEdgeMesh;\n    object e;\n}\n"
    lists = "3\n(\n(0 0 0)\n(0 0 1)\n(0 1 1)\n)\n2\n(\n(0 1)\n(1 2)\n)\n"
    good = "/* a banner\n of two lines */\n" + head + "// ***** //\n" + lists
    yield "edges", good.encode(), None
    yield "one_line", (head + lists).replace("\n", " ").encode(), None
    yield "no_counts", (head + lists.replace("3\n(\n", "(").replace("2\n(\n", "(")).encode(), None
    yield "extended", (head.replace("feature", "extendedFeature") + lists + "0\n0\n4{0}\n").encode(), None
    yield "repeated", (head + lists.replace("2\n(\n", "4\n(\n(1 0)\n(2 2)\n")).encode(), None
    yield "cut", good[:-4].encode(), ["line ", "cut short"]
    yield "header_cut", head[:30].encode(), ["header", "cut short"]
    yield "comment_cut", b"/* FoamFile", ["before 'FoamFile'"]
    for count in ("18446744073709551615", "4000000000"):
        yield f"count_{count}", (head + lists.replace("3\n(", count + "\n(")).encode(), ["item 4 of " + count]
        yield f"edges_{count}", (head + lists.replace("2\n(", count + "\n(")).encode(), ["item 3 of " + count]
    yield "few_announced", (head + lists.replace("2\n(", "1\n(")).encode(), ["line 17", "end of the list of edges"]
    for index in ("3", "-1", "99999999999999999999", "1.5"):
        yield f"index_{index}", (head + lists.replace("(1 2)", f"(1 {index})")).encode(), ["line 17", f"'{index}' is no point, of 3"]
    yield "binary", (head.replace("ascii", "binary") + "3(").encode() + bytes(72), ["line 4", "'binary'", "writeFormat ascii"]
    yield "class", (head.replace("featureEdgeMesh", "vectorField") + lists).encode(), ["line 5", "'vectorField'"]
    yield "no_edges", (head + "3((0 0 0)(0 0 1)(0 1 1)) 0()").encode(), ["no line of two points"]
    yield "uniform", (head + "3{(0 0 0)} 1((0 1))").encode(), ["'{'"]
    yield "word", (head + lists.replace("(0 0 1)", "(0 x 1)")).encode(), ["line 11", "'x'"]
    yield "trailing", (head + lists + "7").encode(), ["'7' after the list"]
    yield "random", b"FoamFile {} " + random.Random(8).randbytes(5000), ["line "]


def line_cases():
    vertices = "".join(f"v {x} {y} {z}\n" for x, y, z in CORNERS)
    yield "edges", (vertices + "l 1 2 4\nl 5 7\n").encode(), None
    yield "of_a_surface", obj_text(more="l 1 2\nl -8 -4\n"), None
    yield "no_lines", obj_text(), ["no line of two points"]
    yield "index_0", (vertices + "l 0 1\n").encode(), ["line 9", "'0'"]
    yield "index_9", (vertices + "l 1 9\n").encode(), ["line 9", "no vertex 9, of 8"]
    yield "one_point", (vertices + "l 1\n").encode(), ["line 9", "two at least"]
    yield "across", (vertices + "l 1 8\n").encode(), ["line 9", "no edge of the triangles"]
    yield "none_of_these", b"edges of a part\n", ["begins like none"]
    yield "empty", b"\n \n", ["empty"]


def obj_cases():
    good = obj_text()
    yield "triangles", good, None
    yield "quads", obj_text(faces=QUADS), None
    yield "negative", "".join(f"v {x} {y} {z}\n" for x, y, z in CORNERS).encode() + \
        "".join(f"f {' '.join(str(v - 8) for v in f)}\n" for f in QUADS).encode(), None
    # Nothing that a file names is opened.
    yield "hostile_names", obj_text(more="mtllib ../../../../etc/passwd /dev/zero\nusemtl " + 3000 * "../" + "\ng \x1b[31m\no " +
                                    9999 * "%s" + "\nmtllib\nusemtl\ng\nmaplib /dev/random\ncall rm -rf\n".replace("call rm -rf\n", "")), None
    yield "calls_a_program", obj_text(more="call ../evil.obj\n"), ["line 9", "'call'"]
    yield "no_bytes", b"", ["empty"]
    yield "no_faces", obj_text(faces=[]), ["no faces"]
    yield "no_vertices", obj_text(vertices=[]), ["face 1 of 12", "0 vertices"]
    for index in ("0", "1.5", "x", "", "99999999999999999999", "-99999999999999999999", "0x1"):
        yield f"index_{index}", good + f"f 1 2 {index}/1\n".encode(), ["line 21"]
    for index in (9, 1 << 31, (1 << 63) - 1):
        yield f"index_{index}", good + f"f 1 2 {index}\n".encode(), ["face 13 of 13", f"vertex {index - 1} ", "8 vertices"]
    yield "index_back", good + b"f 1 2 -9\n", ["line 21", "'-9'", "8 vertices"]
    yield "two_corners", good + b"f 1 2\n", ["line 21", "2 corners"]
    yield "many_corners", good + b"f" + 501 * b" 1" + b"\n", ["face 13 of 13", "501 corners"]
    yield "two_numbers", b"v 1 2\n" + good, ["line 1", "2 values"]
    yield "word", good.replace(b"v 0 0 1", b"v 0 o 1"), ["line 2", "'o'"]
    yield "nan", good.replace(b"v 0 0 1", b"v 0 nan 1"), ["face 1 of 12", "NaN"]
    yield "unused_nan", good + b"v nan inf nan\n", None
    yield "cut", good[:len(good) - 5], ["line 20"]
    yield "statement", good + b"faces 1 2 3\n", ["line 21", "'faces'"]
    yield "flat", obj_text(faces=TRIANGLES[:2]), ["one plane"]
    yield "no_area", obj_text(faces=[(i, i, j) for i in range(8) for j in range(8)]), ["no triangle has an area"], None
    yield "endless_continuation", good + 40000 * b"f \\\n", ["bytes long"]
    yield "continued_at_the_end", good + b"f 1 2 4 \\", None
    yield "long_line", good + b"f" + 99999 * b" 1" + b"\n", ["bytes long"]
    yield "random", random.Random(7).randbytes(5000), ["line 1"]
    yield "zeros", bytes(5000), ["line 1"]


def off_text(counts="8 12 0", vertices=CORNERS, faces=TRIANGLES, first="OFF"):
    return (f"{first}\n{counts}\n" + "".join(f"{x} {y} {z}\n" for x, y, z in vertices) +
            "".join(f"{len(f)} {' '.join(map(str, f))}\n" for f in faces)).encode()


def off_cases():
    good = off_text()
    roomy = good.replace(b"0 0 1\n", b"0.00000000000000000000000000000 0 1\n", 1)  # counts that are off by one could be
    yield "triangles", good, None
    yield "quads", off_text("8 6 12", faces=QUADS), None
    yield "no_bytes", b"", ["empty"]
    yield "only_magic", b"OFF\n", ["ends before the numbers"]
    yield "binary", b"OFF BINARY\n" + bytes(100), ["binary OFF"]
    yield "four_dimensions", off_text(first="4OFF"), ["'4OFF'"]
    for counts in ("4000000000 12 0", "8 2147483648 0", "18446744073709551615 18446744073709551615 0"):
        yield f"counts_{counts.replace(' ', '_')}", off_text(counts), ["line 2", counts.split()[1] + " faces", "bytes are left"]
    for counts in ("-8 12 0", "8", "8 x 0", "8 12 0 7", "99999999999999999999 1 0"):
        yield f"counts_{counts.replace(' ', '_')}", off_text(counts), ["line 2"]
    yield "few_announced", off_text("8 11 0"), ["line 22", "behind the last of 11 faces"]
    yield "many_announced", roomy.replace(b"8 12", b"9 12"), ["ends before the last face"]
    yield "no_faces", off_text("8 0 0", faces=[]), ["no faces"]
    yield "no_vertices", off_text("0 12 0", vertices=[]), ["line 3", "one of 0 vertices"]
    yield "cut", roomy[:len(roomy) - 10], ["line 21"]
    yield "cut_to_size", good[:len(good) - 10], ["line 2", "bytes are left"]
    for index in ("8", "-1", "1.5", "x", "2147483648", "99999999999999999999"):
        yield f"index_{index}", good.replace(b"3 0 1 3", f"3 0 1 {index}".encode()), ["line 11", f"'{index}'"]
    for n in ("4", "4000000000", "18446744073709551615", "-3", "x"):
        yield f"corners_{n}", good.replace(b"3 0 1 3", f"{n} 0 1 3".encode()), ["line 11", f"'{n}'"]
    yield "two_corners", roomy.replace(b"3 0 1 3", b"2 0 1"), ["face 1 of 12", "2 corners"]
    yield "nan", good.replace(b"0 0 1\n", b"0 0 nan\n", 1), ["face 1 of 12", "NaN"]
    yield "word", good.replace(b"0 0 1\n", b"0 0 o\n", 1), ["line 4", "'o'"]
    yield "flat", off_text("8 2 0", faces=TRIANGLES[:2]), ["one plane"]
    yield "random", random.Random(8).randbytes(5000), ["line 1"]
    yield "zeros", bytes(5000), ["line 1"]


def faces_ply(count=12, form="ascii", lists="list uchar int vertex_indices"):
    head = f"ply\nformat {form} 1.0\nelement vertex 8\n" + "".join(f"property float {a}\n" for a in "xyz")
    return f"{head}element face {count}\nproperty {lists}\nend_header\n".encode()


def face_cases():
    """PLY whose faces are the surface."""
    v = "".join(f"{x} {y} {z}\n" for x, y, z in CORNERS).encode()
    f = "".join(f"3 {a} {b} {c}\n" for a, b, c in TRIANGLES).encode()
    b = b"".join(struct.pack("<3f", *x) for x in CORNERS)
    bf = b"".join(struct.pack("<B3i", 3, *t) for t in TRIANGLES)
    little = "binary_little_endian"
    yield "faces_ascii", faces_ply() + v + f, None
    yield "faces_binary", faces_ply(form=little) + b + bf, None
    for count in (1 << 31, 4000000000, (1 << 64) - 1):
        yield f"faces_count_{count}", faces_ply(count, little) + b + bf, [f"{count} x face", "bytes are left"]
        yield f"faces_count_{count}_ascii", faces_ply(count) + v + f, [f"{count} x face", "bytes are left"]
    yield "faces_13", faces_ply(13, little) + b + bf, ["face"]
    yield "faces_11", faces_ply(11, little) + b + bf, ["after the last item"]
    yield "faces_cut", (faces_ply(form=little) + b + bf)[:-5], ["face 12 of 12", "cut short"]
    yield "faces_cut_ascii", faces_ply() + v + f[:-10], ["line "]
    for index in (8, -1, 2147483647):
        yield f"faces_index_{index}", faces_ply(form=little) + b + bf[:-4] + struct.pack("<i", index), \
            ["face 12 of 12", f"vertex {index} ", "8 vertices"]
    yield "faces_index_nan", faces_ply(lists="list uchar float vertex_indices") + v + f.replace(b"3 0 1 3", b"3 0 1 nan"), \
        ["face 1 of 12", "nan"]
    yield "faces_list_255", faces_ply(form=little) + b + b"\xff" + bf[1:], ["face 1 of 12"]
    yield "faces_list_2", faces_ply() + v + f.replace(b"3 0 1 3", b"2 0 1"), ["face 1 of 12", "2 corners"]
    yield "faces_list_501", faces_ply(lists="list uint int vertex_index") + v + f.replace(b"3 0 1 3", b"501" + 501 * b" 1"), \
        ["face 1 of 12", "501 values"]
    yield "faces_nan", faces_ply() + v.replace(b"0 0 1", b"0 0 nan") + f, ["face 1 of 12", "NaN"]
    yield "faces_no_y", faces_ply().replace(b"float y", b"float u") + v + f, ["no property y"]
    yield "faces_label", faces_ply(lists="list uchar int vertex_indices\nproperty float label") + v + \
        f.replace(b"\n", b" 1.5\n"), ["face 1 of 12", "label"]
    yield "faces_flat", faces_ply(2) + v + f[:16], ["one plane"]


# As ParaView and others write them.
no_bytes = ["parts of 0 bytes"]
STORED_WORDS = {
    "appended_no_bytes.vtu": no_bytes, "no_parts_of_no_bytes.vtu": no_bytes,
    "parts_of_no_bytes.vtu": ["three components"],  # its points have eight
    "offset_without_format.vtu": ["'appended]'"], "last_offset.vtu": ["more than the file can hold"],
    "damaged_cell_data.vtu": ["damaged zlib"],
    "appended_beside_underscore.vtu": ["appended data without a beginning"],
    "far_numbers.msh": ["tet 1: its node 3 does not exist"],
    "band.vti": ["hash"], "unknown_type.vti": ["an array of a kind"],
    "bare_crlf.ply": ["12 points"],
}
STORED_STRICT = {"counted_labels.xyz": ["line 2", "no normals"], "bare_crlf.ply": ["no normals"]}


def stored_cases():
    for target in sorted({*TARGETS.values(), "triangles_ply"}):
        for file in sorted((STORED / target).iterdir()):
            is_cloud = target.startswith("cloud")  # of twelve points
            words = STORED_WORDS.get(file.name, ["12 points", "30"] if is_cloud else None)
            yield Case(f"{target}_{file.name}", file.read_bytes(), words, STORED_STRICT.get(file.name, None if is_cloud else words), target=target)


# What is nothing by its beginning, and how it begins.
HUGE = [
    ("zeros.ply", b"", ["line 1 does not end"]),
    ("zeros.pcd", b"", ["line 1 does not end"]),
    ("zeros.xyz", b"", ["line 1 does not end"]),
    ("noise.ply", b"\x8fU\n", ["line 1", "'ply'"]),
    ("no_type.ply", b"ply\nformat ascii 1.0\nelement vertex 9\nproperty real x\nend_header\n", ["line 4", "'real'"]),
    ("no_x.ply", b"ply\nformat ascii 1.0\nelement vertex 9\nproperty float y\nend_header\n", ["property x"]),
    ("count.ply", b"ply\nformat binary_little_endian 1.0\nelement vertex 99999999999\nproperty float x\n"
                  b"property float y\nproperty float z\nend_header\n", ["99999999999 x vertex"], ["no normals"]),
    ("noise.pcd", b"\x8fU\n", ["no line of a PCD header"]),
    ("no_x.pcd", b"VERSION .7\nFIELDS y\nSIZE 4\nTYPE F\nCOUNT 1\nWIDTH 9\nHEIGHT 1\nPOINTS 9\nDATA binary\n", ["field x"]),
    ("noise.xyz", b"1 2 3 0 0 1\nU 2\n", ["line 2"], ["line 1", "no normals"]),
    ("zeros.stl", b"", ["0 triangles"]),
    ("zeros.obj", b"", ["line 1 does not end"]),
    ("zeros.off", b"", ["line 1 does not end"]),
    ("count.stl", bytes(80) + b"\x01", ["1 triangles", "the count is wrong"]),
    ("solid.stl", b"solid\nfacet normal 0 0 1\nouter\n", ["line 3", "'outer'"]),
    ("noise.obj", b"v 1 2 3\nU\n", ["line 2", "'U'"]),
    ("count.off", b"OFF\n99999999999 1 0\n", ["line 2", "99999999999 vertices"]),
    ("faces.ply", b"ply\nformat binary_little_endian 1.0\nelement vertex 99999999999\nproperty float x\nproperty float y\n"
                  b"property float z\nelement face 99999999999\nproperty list uchar int vertex_index\nend_header\n",
     ["99999999999 x vertex"]),
    ("zeros.feat", b"feat 1\n", ["too large for a file of edges"]),
    ("zeros.vtu", b"", ["no <VTKFile"]),
    ("zeros.msh", b"", ["no $MeshFormat"]),
    ("zeros.mesh", b"", ["no MeshVersionFormatted"]),
    ("zeros.inp", b"", ["no *NODE"]),
    ("zeros.nrrd", b"", ["neither VTK"]),
    ("count.nrrd", nrrd(b"", sizes="2000 2000 2000"), ["nodes, and at most"]),
    ("count.nii", nifti(b"", dim=(3, 2000, 2000, 2000, 1, 1, 1, 1)), ["nodes, and at most"]),
    ("line.vtk", b"# vtk DataFile Version 3.0\n", ["more than 65536 bytes"]),
    ("tag.grid", b'<VTKFile type="ImageData">', ["more than 65536 bytes"]),
]


def made_cases():
    for name, data, words, *strict in face_cases():
        yield Case(name + ".ply", data, words, *(strict or [words]), target="triangles_ply")
    for suffix, family in ((".ply", ply_cases), (".pcd", pcd_cases), (".xyz", xyz_cases), (".pts", pts_cases),
                           (".csv", csv_cases), (".asc", asc_cases),
                           (".las", las_cases), (".e57", e57_cases), (".points", unknown_cases), (".msh", msh_cases), (".mesh", mesh_cases), (".inp", inp_cases), (".vtu", vtu_cases),
                           (".nrrd", nrrd_cases), (".nii", nifti_cases), (".vtk", vtk_cases), (".grid", image_cases),
                           (".stl", stl_cases), (".obj", obj_cases), (".off", off_cases),
                           (".feat", feat_cases), (".eMesh", emesh_cases), (".lines", line_cases),
                           (".tets", other_cases)):
        for name, data, words, *strict in family():
            yield Case(name + suffix, data, words, *(strict or [words]))


def cases():
    yield from made_cases()
    yield from stored_cases()
    for name, data, words, *strict in HUGE:
        yield Case(f"huge_{name}", data, words, *(strict or [words]), is_huge=True)


def main():
    for case in made_cases():
        suffix = pathlib.Path(case.name).suffix
        target = case.target or TARGETS.get(suffix)
        if target and len(case.data) <= 20000:  # libFuzzer's -max_len, too
            folder = pathlib.Path(sys.argv[1]) / target
            folder.mkdir(parents=True, exist_ok=True)
            (folder / case.name).write_bytes(case.data)


if __name__ == "__main__":
    main()
