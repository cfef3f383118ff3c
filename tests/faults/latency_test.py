"""How long a run of a million points and a million tets goes on after SIGINT, at random times of every stage.

With UMTET_SLOW=1 only: minutes, and times on the wall. UMTET_TRIES=n a stage (default 7), UMTET_POINTS=n.
"""
import os
import random
import shutil
import signal
import struct
import subprocess
import time
import unittest

from math import cos, pi, sin

from support import PROGRAM, SLOW, Folder, run

POINTS = int(os.environ.get("UMTET_POINTS", "1000000"))
TRIES = int(os.environ.get("UMTET_TRIES", "7"))
PROMISED = .2  # seconds
STAGES = ("cloud", "level-set", "mesh")


def torus(path, n):
    """n points of a torus with radii 1 and .4, evenly spread, as binary PLY in single precision."""
    head = ["ply", "format binary_little_endian 1.0", f"element vertex {n}"]
    head += [f"property float {p}" for p in ("x", "y", "z", "nx", "ny", "nz")] + ["end_header", ""]
    with open(path, "wb") as file:
        file.write("\n".join(head).encode())
        for i in range(n):
            u, v = 2 * pi * ((i * .7548776662466927) % 1), 2 * pi * ((i * .5698402909980532) % 1)
            normal = (cos(v) * cos(u), cos(v) * sin(u), sin(v))
            file.write(struct.pack("<6f", cos(u) + .4 * normal[0], sin(u) + .4 * normal[1], .4 * normal[2], *normal))
    return path


@unittest.skipUnless(SLOW, "UMTET_SLOW=1")
class Latency(unittest.TestCase):
    def test_every_stage_ends_soon_after_a_signal(self):
        random.seed(2)
        with Folder() as folder:
            cloud = torus(folder / "torus.ply", POINTS)

            def arguments(stage):
                size = ["--tets", POINTS] if stage == "mesh" else []
                return ["run", cloud, "-o", folder / "case", "--until", stage, "--progress", "none", *size]

            seconds, late = {}, []
            for stage in STAGES:
                shutil.rmtree(folder / stage, ignore_errors=True)
                if (folder / "case").exists():
                    shutil.copytree(folder / "case", folder / stage, copy_function=os.link)
                start = time.monotonic()
                made = run(*arguments(stage), timeout=1800)
                self.assertEqual(made.returncode, 0, made.stderr)
                seconds[stage] = time.monotonic() - start
            for stage in STAGES:
                longest = 0
                for _ in range(TRIES):
                    shutil.rmtree(folder / "case")
                    if (folder / stage).exists():
                        shutil.copytree(folder / stage, folder / "case", copy_function=os.link)
                    process = subprocess.Popen([PROGRAM, *map(str, arguments(stage))], stdout=subprocess.DEVNULL,
                                               stderr=subprocess.PIPE, text=True)
                    after = random.uniform(.02, seconds[stage])
                    time.sleep(after)
                    asked = time.monotonic()
                    process.send_signal(signal.SIGINT)
                    said = process.communicate(timeout=60)[1]
                    took = time.monotonic() - asked
                    if process.returncode == 0:
                        continue  # it was done already
                    self.assertIn(process.returncode, (130, -signal.SIGINT), said)  # the latter: not in main() yet
                    longest = max(longest, took)
                    if took > PROMISED:
                        late.append(f"{stage} after {after:.2f} s: {took:.3f} s: {said.strip()}")
                print(f"{stage}: {seconds[stage]:.1f} s, the longest of {TRIES} stops {longest:.3f} s", flush=True)
            self.assertEqual(late, [])


if __name__ == "__main__":
    unittest.main()
