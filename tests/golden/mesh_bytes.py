#!/usr/bin/python3
"""Meshes have the bytes they had: checksums of the meshes of clouds, formulas, modes and steps in mesh_bytes.json.

usage: mesh_bytes.py UMTET SOURCES [NAME ...] [--write | --contents]

--contents: a checksum is that of the file with each array in its place, in base64, instead of appended. Version 0.9 wrote
files like that, so this compares points, tets and all arrays with a mesh_bytes.json of it, bit by bit.
Bytes are those of one compiler and one instruction set; with others this says what differs, and no more. Certificates
are stored beside the checksums, without the block `run` and the version, so that a difference can be read.
"""
import base64
import hashlib
import json
import os
import re
import struct
import subprocess
import sys
import tempfile

STORED = os.path.join(os.path.dirname(os.path.abspath(__file__)), "mesh_bytes.json")
CLOUDS = ["bird", "blob_nonuniform", "duck", "knot", "torus_hole_noise"]
BALL_BOX = "--box=-1.2,-1.2,-1.2,1.2,1.2,1.2"
EQ_9 = ["--implicit", "2*y*(y^2-3*x^2)*(1-z^2)+(x^2+y^2)^2-(9*z^2-1)*(1-z^2)", "--box=-2.1,-2.1,-1.05,2.1,2.1,1.05"]
EQ_13 = ["--implicit", "x^2+y^2+z^2+sin(t*x)+sin(t*y)+sin(t*z)-1", "--box=-2.1,-2.1,-2.1,2.1,2.1,2.1"]
T_6 = "+".join(f"32*{x}^6-48*{x}^4+18*{x}^2-1" for x in "xyz")
SPHERE = ["--implicit", "x^2+y^2+z^2-1", BALL_BOX]
TORUS = ["--implicit", "(sqrt(x^2+y^2)-1)^2+z^2-.16", "--box=-1.5,-1.5,-.5,1.5,1.5,.5"]
MESHES = {
    "sphere": SPHERE + ["--tets", "100000"],
    "torus": TORUS + ["--tets", "100000"],
    "eq_9": EQ_9 + ["--tets", "100000"],
    "t_6": ["--implicit", T_6, BALL_BOX, "--tets", "100000"],
    "eq_9_paper": EQ_9 + ["--tets", "20000", "--mode", "paper"],
    "sphere_order_2": SPHERE + ["--tets", "5000", "--order", "2"],
    "complement": SPHERE[:2] + ["--complement", "--box-walls", "--box=-2,-1.5,-2,4,2,2", "--h", ".15"],
}
NAMES = CLOUDS + list(MESHES) + ["eq_13"]


def commands(umtet, sources, name, case):
    quiet = ["--progress", "none", "-q"]
    if name in CLOUDS:
        return [umtet, "run", f"{sources}/data/clouds/{name}.ply", "-o", case, "--no-report"] + quiet
    if name == "eq_13":
        return [umtet, "evolve"] + EQ_13 + ["--h", ".0922", "--t", "0:3.2:3.2", "-o", case] + quiet
    return [umtet, "mesh"] + MESHES[name] + ["-o", case, "--no-report"] + quiet


def inline(file):
    """The bytes of a file with raw appended arrays as those of one whose arrays are inline, in base64."""
    begin = b'<AppendedData encoding="raw">\n_'
    end = b"\n</AppendedData>\n"
    tags, data = file.split(begin, 1)

    def block(found):
        at = int(found.group(1))
        size, = struct.unpack_from("<Q", data, at)
        return b' format="binary">\n' + base64.b64encode(data[at:at + 8 + size]) + b"\n</DataArray>\n"

    return re.sub(rb' format="appended" offset="(\d+)"/>\n', block, tags) + data[data.rindex(end) + len(end):]


def checksum(path):
    with open(path, "rb") as f:
        content = f.read()
    return hashlib.sha256(inline(content) if "--contents" in sys.argv else content).hexdigest()


def measured(umtet, sources, name, folder):
    case = os.path.join(folder, name)
    subprocess.run(commands(umtet, sources, name, case), check=True, stdout=subprocess.DEVNULL)
    if name == "eq_13":
        return {"sha256": {step: checksum(f"{case}/{step}") for step in ("step_0000.vtu", "step_0001.vtu")}}
    with open(f"{case}/certificate.json", encoding="utf8") as f:
        certificate = json.load(f)
    del certificate["run"], certificate["version"]
    return {"sha256": {"mesh.vtu": checksum(f"{case}/3-mesh/mesh.vtu")}, "certificate": certificate}


def main():
    umtet, sources = sys.argv[1:3]
    names = [a for a in sys.argv[3:] if not a.startswith("--")] or NAMES
    stored = {}
    if os.path.exists(STORED):
        with open(STORED, encoding="utf8") as f:
            stored = json.load(f)
    different = []
    with tempfile.TemporaryDirectory() as folder:
        for name in names:
            now = measured(umtet, sources, name, folder)
            if "--write" in sys.argv:
                stored[name] = now
            elif stored[name] != now:
                different.append(name)
                kind = "other bytes" if stored[name]["sha256"] != now["sha256"] else "another certificate"
                print(f"{name}: {kind}")
                for key, value in now.get("certificate", {}).items():
                    if stored[name]["certificate"].get(key) != value:
                        print(f"  {key}: {stored[name]['certificate'].get(key)} -> {value}")
                for key in stored[name].get("certificate", {}):
                    if key not in now["certificate"]:
                        print(f"  {key} is gone")
    if "--write" in sys.argv:
        with open(STORED, "w", encoding="utf8") as f:
            json.dump(stored, f, indent=1)
            f.write("\n")
    print(f"{len(names) - len(different)} of {len(names)} as stored")
    return 1 if different else 0


if __name__ == "__main__":
    sys.exit(main())
