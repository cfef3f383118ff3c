#!/usr/bin/python3
"""What must become of every file of the corpus (cases.py), by the program from outside and by the readers of the libraries: it
is read, or refused with exit code 3, fast, in little memory, in one line that names file and place.
usage: tests/corpus/corpus_test.py UMTET READ_CORPUS [--sanitized]"""
import os
import pathlib
import resource
import subprocess
import sys
import tempfile

import cases

# Limits of one call. The program itself, with its libraries, takes some 45 MB before it reads a byte.
CPU_SECONDS = 1
MEGABYTES = 100
# Address space, so that an allocation out of a header fails even where no page of it is touched.
ADDRESS_SPACE = 4 << 30
# Sparse. Reading so much, if only for a checksum, takes longer than the seconds after which a call is killed.
HUGE_BYTES = 64 << 30
MESHES = (".vtu", ".msh", ".mesh", ".inp", ".tets")
TRIANGLES = (".stl", ".obj", ".off")


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


def wrong_words(file, words, text):
    """What is wrong with the line of a refusal; it begins with the name of the file."""
    if len(text.splitlines()) != 1 or len(text) > len(str(file)) + 400:
        yield f"{len(text.splitlines())} lines, {len(text)} characters"
    if not text.startswith(f"{file}: "):
        yield "the file is not named"
    if not all(" " <= c <= "~" for c in text.rstrip("\n")):
        yield "bytes that are no text"
    yield from (f"'{word}' is missing" for word in words if word not in text)


def troubles(file, words, code, text, seconds, megabytes, limited):
    """What is wrong with the answer of the program to one file."""
    wanted = (3,) if words is not None else (0, 6) if file.suffix in MESHES else (0,)  # a mesh that is read may fail its gate
    if code not in wanted:
        yield f"exit {code} instead of {wanted[0]}"
    if words is not None:
        yield from wrong_words(file, words, text.removeprefix("umtet: "))
    if limited and seconds > CPU_SECONDS:
        yield f"{seconds:.2f} s of CPU"
    if limited and megabytes > MEGABYTES:
        yield f"{megabytes:.0f} MB"


def answers_of_readers(program, files):
    """(file, reader, answer)"""
    out = subprocess.run([program, *map(str, files)], capture_output=True, encoding="utf-8", errors="backslashreplace", check=True)
    return [line.split("\t", 2) for line in out.stdout.splitlines()]


def main():
    program, readers, limited = sys.argv[1], sys.argv[2], "--sanitized" not in sys.argv
    n_bad, slowest, largest, table = 0, 0, 0, {}
    with tempfile.TemporaryDirectory() as temporary:
        folder = pathlib.Path(temporary)
        for n, case in enumerate(cases.cases()):
            file = folder / case.name
            table[str(file)] = case
            file.write_bytes(case.data)
            if case.is_huge:
                os.truncate(file, HUGE_BYTES)
            # The readers are asked below: of meshes, and of clouds in a whole run, some files are enough here.
            some, is_cloud = case.is_huge or n % 4 == 0, file.suffix not in (*MESHES, *cases.GRIDS, ".vti")
            calls = []
            if file.suffix in cases.EDGES:
                cube = folder / "cube.of.edges.obj"
                cube.write_bytes(cases.obj_text())
                if case.words is not None:
                    calls.append(["inspect", str(cube), "--features", str(file)])
                is_cloud = False
            # Of triangles that are accepted samples are taken, which takes longer.
            if is_cloud and not (case.words is None and ((case.target or "").startswith("triangles") or file.suffix in TRIANGLES)):
                calls.append(["inspect", str(file)])
            if is_cloud and some and case.words is not None:
                calls.append(["run", str(file), "-o", str(folder / "case")])
            if file.suffix in MESHES and some:
                calls.append(["check", str(file)])
            if file.suffix in cases.GRIDS and some and case.words is not None:
                calls.append(["mesh", "--level-set", str(file), "-o", str(folder / "case")])
            for arguments in calls:
                answer = call(program, arguments, limited)
                slowest, largest = max(slowest, answer[2]), max(largest, answer[3])
                for trouble in troubles(file, case.words, *answer, limited):
                    n_bad += 1
                    print(f"umtet {arguments[0]} {case.name}: {trouble}: {answer[1].strip()[:300]}")
        answers = answers_of_readers(readers, table)
        for file, reader, text in answers:
            case = table[file]
            words = case.strict if reader in ("read_point_cloud", "read_triangles") else case.words
            if (text == "accepted") != (words is None):
                wrong = ["read" if words else "refused"]
            else:
                wrong = [] if words is None else wrong_words(file, words, text)
            for trouble in wrong:
                n_bad += 1
                print(f"{reader} {case.name}: {trouble}: {text[:300]}")
        n_bad += len({file for file, _, _ in answers}) != len(table)
    print(f"{len(table)} files, {n_bad} troubles; at most {slowest:.2f} s of CPU and {largest:.0f} MB")
    return n_bad > 0


if __name__ == "__main__":
    sys.exit(main())
