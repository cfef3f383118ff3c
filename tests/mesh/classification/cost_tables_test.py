#!/usr/bin/python3
"""The star cost tables are those that star_costs makes: a fifth of its bodies, where they met a configuration often.

usage: cost_tables_test.py STAR_COSTS SOURCES
"""
import re
import subprocess
import sys
import unittest

STAR_COSTS, SOURCES = sys.argv[1:3]
BODIES, OFTEN, TOLERANCE = 12, 1000, 0.015


def qualities(text):
    """(site, positive faces, tets) -> (quality, vertices seen)"""
    rows = re.findall(r"\{(\d+), (\d+), (\d+), (0\.\d+)\},  // (\d+)", text)
    return {tuple(map(int, row[:3])): (float(row[3]), int(row[4])) for row in rows}


class StarCostTables(unittest.TestCase):
    def check(self, tiling):
        with open(f"{SOURCES}/mesh/classification/tables/{tiling}.h") as f:
            text = f.read()
        self.assertRegex(text, f"// Made by: star_costs {tiling} 1 ")
        stored = qualities(text)
        made = qualities(subprocess.run([STAR_COSTS, tiling, "1", str(BODIES)], check=True, capture_output=True, text=True).stdout)
        often = {configuration: quality for configuration, (quality, seen) in made.items() if seen >= OFTEN}
        self.assertGreater(len(often), 5)
        for configuration, quality in often.items():
            self.assertAlmostEqual(quality, stored[configuration][0], delta=TOLERANCE, msg=f"{tiling} {configuration}")

    def test_a15(self):
        self.check("a15")

    def test_slab(self):
        self.check("slab")

    def test_cube(self):
        self.check("cube")


if __name__ == "__main__":
    unittest.main(argv=sys.argv[:1])
