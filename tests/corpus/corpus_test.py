#!/usr/bin/python3
"""Every malformed cloud is refused by the program from outside: exit 3, fast, in little memory, in one line that names
file and place. usage: tests/corpus/corpus_test.py UMTET [--sanitized]"""
import os
import pathlib
import resource
import subprocess
import sys
import tempfile

import malformed_clouds

# Limits of one call. The program itself, with its libraries, takes some 45 MB before it reads a byte.
CPU_SECONDS = 1
MEGABYTES = 100
# Address space, so that an allocation out of a header fails even where no page of it is touched.
ADDRESS_SPACE = 4 << 30
# What is no cloud by its beginning, and how it begins. Sparse: zeros follow. Reading so much, if only for a checksum,
# takes longer than the seconds after which a call is killed.
HUGE_BYTES = 64 << 30
HUGE = [
    ("zeros.ply", b"", ["line 1 does not end"]),
    ("zeros.pcd", b"", ["line 1 does not end"]),
    ("zeros.xyz", b"", ["line 1 does not end"]),
    ("noise.ply", b"\x8fU\n", ["line 1", "'ply'"]),
    ("no_type.ply", b"ply\nformat ascii 1.0\nelement vertex 9\nproperty real x\nend_header\n", ["line 4", "'real'"]),
    ("no_x.ply", b"ply\nformat ascii 1.0\nelement vertex 9\nproperty float y\nend_header\n", ["property x"]),
    ("count.ply", b"ply\nformat binary_little_endian 1.0\nelement vertex 99999999999\nproperty float x\n"
                  b"property float y\nproperty float z\nend_header\n", ["99999999999 x vertex"]),
    ("noise.pcd", b"\x8fU\n", ["no line of a PCD header"]),
    ("no_x.pcd", b"VERSION .7\nFIELDS y\nSIZE 4\nTYPE F\nCOUNT 1\nWIDTH 9\nHEIGHT 1\nPOINTS 9\nDATA binary\n", ["field x"]),
    ("noise.xyz", b"1 2 3 0 0 1\nU 2\n", ["line 2"]),
    ("zeros.vtu", b"", ["no <VTKFile"]),
    ("zeros.msh", b"", ["no $MeshFormat"]),
    ("zeros.mesh", b"", ["no MeshVersionFormatted"]),
]


def call(program, arguments, limited):
    """Exit code, text of stderr, CPU seconds and peak megabytes."""

    def limit():
        resource.setrlimit(resource.RLIMIT_CPU, (20, 20))
        if limited:
            resource.setrlimit(resource.RLIMIT_AS, (ADDRESS_SPACE, ADDRESS_SPACE))

    with tempfile.TemporaryFile() as err:
        process = subprocess.Popen([program] + arguments, stdout=subprocess.DEVNULL, stderr=err, preexec_fn=limit)
        _, status, usage = os.wait4(process.pid, 0)
        process.returncode = os.waitstatus_to_exitcode(status)
        err.seek(0)
        text = err.read().decode("utf-8", "backslashreplace")
    return process.returncode, text, usage.ru_utime + usage.ru_stime, usage.ru_maxrss / 1024


def troubles(file, words, code, text, seconds, megabytes, limited):
    """What is wrong with the answer to one file."""
    wanted = 0 if words is None else 3
    if code != wanted:
        yield f"exit {code} instead of {wanted}"
    if words is not None:
        lines = text.splitlines()
        if len(lines) != 1 or len(text) > len(str(file)) + 400:
            yield f"{len(lines)} lines, {len(text)} characters"
        if not text.startswith(f"umtet: {file}: "):
            yield "the file is not named"
        if not all(" " <= c <= "~" for c in text.rstrip("\n")):
            yield "bytes that are no text"
        yield from (f"'{word}' is missing" for word in words if word not in text)
    if limited and seconds > CPU_SECONDS:
        yield f"{seconds:.2f} s of CPU"
    if limited and megabytes > MEGABYTES:
        yield f"{megabytes:.0f} MB"


def main():
    program, limited = sys.argv[1], "--sanitized" not in sys.argv
    n, n_bad, slowest, largest = 0, 0, 0, 0
    with tempfile.TemporaryDirectory() as temporary:
        folder = pathlib.Path(temporary)
        huge = [(f"huge_{name}", data, words) for name, data, words in HUGE]
        for name, data, words in [*malformed_clouds.cases(), *huge]:
            file = folder / name
            file.write_bytes(data)
            is_huge = name.startswith("huge_")
            if is_huge:
                os.truncate(file, HUGE_BYTES)
            is_mesh = file.suffix in (".vtu", ".msh", ".mesh")
            calls = [["check" if is_mesh else "inspect", str(file)]]
            if words is not None and not is_mesh and (is_huge or n % 4 == 0):  # the same reader: some files are enough
                calls.append(["run", str(file), "-o", str(folder / "case")])
            for arguments in calls:
                answer = call(program, arguments, limited)
                slowest, largest = max(slowest, answer[2]), max(largest, answer[3])
                for trouble in troubles(file, words, *answer, limited):
                    n_bad += 1
                    print(f"umtet {arguments[0]} {name}: {trouble}: {answer[1].strip()[:300]}")
            n += 1
    print(f"{n} files, {n_bad} troubles; at most {slowest:.2f} s of CPU and {largest:.0f} MB")
    return n_bad > 0


if __name__ == "__main__":
    sys.exit(main())
