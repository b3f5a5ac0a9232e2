#!/usr/bin/env python3
"""Measures the processor time of every compilation and link: ninja's log has wall time only.

usage: cmake --preset asan-ubsan -DCMAKE_CXX_COMPILER_LAUNCHER=$PWD/scripts/processor_time.py \\
             -DCMAKE_CXX_LINKER_LAUNCHER=$PWD/scripts/processor_time.py
       PROCESSOR_TIME_LOG=/tmp/log ninja -C build/asan-ubsan
       processor_time.py show LOG ...      seconds of every target, one column a log; the newest of a file counts
"""
import os
import re
import resource
import subprocess
import sys
from collections import Counter


def run(command):
    code = subprocess.call(command)
    used = resource.getrusage(resource.RUSAGE_CHILDREN)
    output = command[command.index("-o") + 1] if "-o" in command else command[-1]
    if log := os.environ.get("PROCESSOR_TIME_LOG"):
        with open(log, "a") as out:
            out.write(f"{used.ru_utime + used.ru_stime:.2f} {output}\n")
    return code


def read(log):
    with open(log) as lines:
        newest = {output: float(seconds) for seconds, output in (line.split() for line in lines)}
    seconds = Counter()
    for output, took in newest.items():
        found = re.search(r"([^/]*)\.dir/", output)
        seconds[found[1] if found else "links"] += took
    return seconds


def show(logs):
    columns = [read(log) for log in logs]
    for target in sorted(set().union(*columns), key=lambda name: -max(c[name] for c in columns)):
        print(*(f"{c[target]:8.1f}" for c in columns), target)
    print(*(f"{sum(c.values()):8.1f}" for c in columns), "in all")


if __name__ == "__main__":
    if len(sys.argv) < 2:
        sys.exit(__doc__)
    if sys.argv[1] == "show":
        show(sys.argv[2:])
    else:
        sys.exit(run(sys.argv[1:]))
