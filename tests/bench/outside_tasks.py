#!/usr/bin/python3
"""Which share of the CPU time one thread spends outside of all tasks, by function: samples of perf, so that what else
the machine does counts nothing.

usage: perf record -F 40 -e cpu-clock --call-graph dwarf,65000 PROGRAM
       perf script --no-inline | outside_tasks.py FUNCTION ...

A sample counts for the first of these functions that is on its stack. Work of tasks is counted together: other threads
do not know who waits for them. Stacks of more than perf keeps, 64 kB, tell nothing; they are those of tasks with large
arrays, and are left out.
"""
import collections
import re
import sys

# oneTBB's frames around a task, and a thread that is not the program's first.
TASK = re.compile(r"tbb.*(execute|task|local_wait|start_for|dispatch)|start_thread")
BOTTOM = re.compile(r"\b(_start|start_thread|clone3?)\b")


def stacks(lines):
    stack = []
    for line in lines:
        line = line.strip()
        if line:
            stack.append(line)
        elif stack:
            yield stack[1:]
            stack = []
    if stack:
        yield stack[1:]


def main(functions):
    names = [re.compile(rf"\b{re.escape(f)}\b") for f in functions]
    outside = collections.Counter()
    n = n_cut_off = 0
    for stack in stacks(sys.stdin):
        if not any(BOTTOM.search(frame) for frame in stack):
            n_cut_off += 1
            continue
        n += 1
        if any(TASK.search(frame) for frame in stack):
            continue
        found = (f for f, name in zip(functions, names) if any(name.search(frame) for frame in stack))
        outside[next(found, "elsewhere")] += 1
    if n == 0:
        sys.exit("no samples")
    for function in [*functions, "elsewhere"]:
        print(f"{function:20} {100 * outside[function] / n:5.1f} %")
    print(f"{'left out':20} {100 * n_cut_off / (n + n_cut_off):5.1f} %")
    share = sum(outside.values()) / n
    print(f"{'all':20} {100 * share:5.1f} %: at most {1 / (share + (1 - share) / 2):.2f} times faster on 2 cores, "
          f"{1 / (share + (1 - share) / 16):.1f} on 16")


if __name__ == "__main__":
    main(sys.argv[1:])
