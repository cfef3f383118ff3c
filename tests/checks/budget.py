#!/usr/bin/python3
"""Compares the time of the last complete run of the suite with its budget.

usage: budget.py BUILD [--write]

BUILD is a build folder in which ctest has run. The budget is the table of tests/README.md: the total of all tests, in
seconds on a quiet machine, and the ten slowest. The check fails if the total exceeds the budget by a third. --write
stores the measured table. A run of fewer tests than the table names is refused.
"""
import os
import re
import sys

README = os.path.join(os.path.dirname(os.path.dirname(os.path.abspath(__file__))), "README.md")
BEGIN, END = "<!-- budget -->\n", "<!-- end of budget -->\n"
TEST = re.compile(r"^\d+/\d+ Testing: (\S+)$.*?^Test time = +([\d.]+) sec$", re.M | re.S)
TOTAL = re.compile(r"^\| all (\d+) tests \| (\d+) \|$", re.M)
OVER = 4 / 3


def table(seconds):
    """The ten slowest tests, by name, and the total."""
    slowest = sorted(seconds.items(), key=lambda row: (-row[1], row[0]))[:10]
    rows = [f"| `{name}` | {s:.0f} |\n" for name, s in slowest]
    return f"| test | seconds |\n|---|---|\n{''.join(rows)}| all {len(seconds)} tests | {sum(seconds.values()):.0f} |\n"


def main():
    with open(os.path.join(sys.argv[1], "Testing", "Temporary", "LastTest.log"), encoding="utf8", errors="replace") as f:
        seconds = {name: float(s) for name, s in TEST.findall(f.read())}
    with open(README, encoding="utf8") as f:
        before, rest = f.read().split(BEGIN)
    stored, after = rest.split(END)
    now = table(seconds)
    if "--write" in sys.argv[2:]:
        with open(README, "w", encoding="utf8") as f:
            f.write(before + BEGIN + now + END + after)
        return 0
    print(now, end="")
    n_tests, budget = (int(x) for x in TOTAL.search(stored).groups())
    if len(seconds) < n_tests:
        sys.exit(f"budget.py: {len(seconds)} of {n_tests} tests ran last")
    total = sum(seconds.values())
    print(f"budget: {budget} s; {100 * total / budget:.0f} % of it")
    return 1 if total > OVER * budget else 0


if __name__ == "__main__":
    sys.exit(main())
