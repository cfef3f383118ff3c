"""How long a run of a million points and a million tets goes on after SIGINT, at random times of every stage.

With UMTET_SLOW=1 only: minutes. Times are those on the wall, or, where others keep the machine busy, what the process would
have taken alone on one thread. UMTET_TRIES=n a stage (default 7), UMTET_POINTS=n.
"""
import os
import pathlib
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
PATIENCE = .1  # of pipeline/case/interrupt.cpp
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


def times(pid):
    """User and system seconds of a process so far."""
    fields = pathlib.Path(f"/proc/{pid}/stat").read_text().rsplit(")", 1)[1].split()
    return [int(fields[k]) / os.sysconf("SC_CLK_TCK") for k in (11, 12)]


@unittest.skipUnless(SLOW, "UMTET_SLOW=1")
class Latency(unittest.TestCase):
    def test_every_stage_ends_soon_after_a_signal(self):
        random.seed(2)
        with Folder() as folder:
            cloud = torus(folder / "torus.ply", POINTS)

            def arguments(stage):
                size = ["--tets", POINTS] if stage == "mesh" else []
                return ["run", cloud, "-o", folder / "case", "--until", stage, "--threads", 1, "--progress", "none", *size]

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
                    said, after = folder / "said", random.uniform(.02, seconds[stage])
                    with open(said, "w") as file:
                        process = subprocess.Popen([PROGRAM, *map(str, arguments(stage))], stdout=subprocess.DEVNULL,
                                                   stderr=file)
                    time.sleep(after)
                    before, asked = times(process.pid), time.monotonic()
                    os.kill(process.pid, signal.SIGINT)  # send_signal() would wait for it where it has ended
                    _, status, usage = os.wait4(process.pid, 0)
                    wall, code = time.monotonic() - asked, os.waitstatus_to_exitcode(status)
                    process.returncode = code
                    if code == 0:
                        continue  # it was done already
                    self.assertIn(code, (130, -signal.SIGINT), said.read_text())  # the latter: not in main() yet
                    user, system = usage.ru_utime - before[0], usage.ru_stime - before[1]
                    # A step that did not ask has been ended by a timer.
                    alone = PATIENCE + system if said.read_text().startswith("\n") else user + system
                    took = min(wall, alone)
                    longest = max(longest, took)
                    if took > PROMISED:
                        late.append(f"{stage} after {after:.2f} s: {took:.3f} s, {wall:.3f} on the wall")
                print(f"{stage}: {seconds[stage]:.1f} s, the longest of {TRIES} stops {longest:.3f} s", flush=True)
            self.assertEqual(late, [])


if __name__ == "__main__":
    unittest.main()
