"""The gate lets through what costs as much as before, and names a phase that costs 15 % more.

usage: gate_test.py PHASE_BENCH
"""
import os
import pathlib
import subprocess
import sys
import tempfile

GATE = pathlib.Path(__file__).with_name("gate.py")


def gate(reference, *more, slower=None):
    environment = dict(os.environ, **({"UMTET_SLOWER": slower} if slower else {}))
    done = subprocess.run(
        [sys.executable, GATE, sys.argv[1], "--reference", reference, "--only", "projection|embedding", *more],
        env=environment, capture_output=True, text=True)
    return done.returncode, done.stdout + done.stderr


def main():
    with tempfile.TemporaryDirectory() as folder:
        reference = str(pathlib.Path(folder) / "phases.json")
        code, said = gate(reference, "--write")
        assert code == 0, said
        code, said = gate(reference)
        assert code == 0 and "embedding, projection" in said, said
        code, said = gate(reference, slower=".15")
        assert code == 1 and said.startswith("projection: costs 1") and "embedding" not in said, said
        code, said = gate(reference, "--only", ".")
        assert code != 0 and "nothing is stored for" in said, said
    print("ok")


if __name__ == "__main__":
    main()
