#!/usr/bin/env python3
"""Prints what the builds and the tests spent their time on.

usage: build_times.py [--top N] [--headers] [BUILD_FOLDER ...]     default: build/release
       build_times.py --costs > scripts/step_costs.txt                 of a release build, for the time left

From the ninja log of each folder: the costliest steps and targets; from ctest's record: the costliest
tests. --headers compiles every source of build/analysis once more with clang -ftime-trace (some
minutes) and prints the headers that cost most over all sources.
"""
import argparse
import json
import re
import subprocess
import sys
import tempfile
from collections import Counter
from concurrent.futures import ThreadPoolExecutor
from os import cpu_count
from pathlib import Path

ROOT = Path(__file__).resolve().parents[1]


def read_ninja_log(folder):
    """{output: seconds} of the newest run of every step."""
    steps = {}
    for line in (folder / ".ninja_log").read_text().splitlines():
        if not line.startswith("#"):
            start, end, _, output, _ = line.split("\t")
            steps[output] = (int(end) - int(start)) / 1000
    return steps


def target_of(output):
    found = re.search(r"([^/]*)\.dir/", output)
    return found[1] if found else "link and generate"


def read_tests(folder):
    """{test: seconds} of the newest run of ctest; empty where there was none."""
    log = folder / "Testing" / "Temporary" / "CTestCostData.txt"
    rows = log.read_text().split("---")[0].splitlines() if log.exists() else []
    return {name: float(cost) for name, _, cost in (row.split() for row in rows)}


def trace(arguments, folder, place, number):
    output = place / f"{number}.o"
    subprocess.run([*arguments[:arguments.index("-o")], "-w", "-ftime-trace", "-c", arguments[-1],
                    "-o", str(output)], cwd=folder, check=True)
    events = json.loads(output.with_suffix(".json").read_text())["traceEvents"]
    output.unlink()
    return [(e["args"]["detail"], e["dur"] / 1e6) for e in events if e["name"] == "Source"]


def measure_headers(folder):
    """(seconds, readings) of every header over all sources, including the headers that it includes."""
    commands = folder / "compile_commands.json"
    if not commands.exists():
        sys.exit(f"{commands} is missing: run `cmake --preset analysis` first")
    seconds, readings = Counter(), Counter()
    entries = json.loads(commands.read_text())
    with tempfile.TemporaryDirectory() as place, ThreadPoolExecutor(cpu_count()) as pool:
        jobs = [pool.submit(trace, e["command"].split(), e["directory"], Path(place), i)
                for i, e in enumerate(entries)]
        for done, job in enumerate(jobs):
            if sys.stderr.isatty():
                print(f"\r{done} of {len(jobs)} sources", end="", file=sys.stderr)
            for header, took in job.result():
                seconds[header] += took
                readings[header] += 1
    return seconds, readings


def table(title, rows, top):
    print(f"\n{title}, {sum(rows.values()):.0f} s in all")
    for name, seconds in sorted(rows.items(), key=lambda row: -row[1])[:top]:
        print(f"{seconds:8.1f} s  {name}")


def main():
    parser = argparse.ArgumentParser(description=__doc__.split("\n")[0])
    parser.add_argument("--top", type=int, default=15)
    parser.add_argument("--headers", action="store_true")
    parser.add_argument("--costs", action="store_true")
    parser.add_argument("folders", nargs="*", type=Path, default=[ROOT / "build" / "release"])
    options = parser.parse_args()
    if options.costs:
        for output, seconds in sorted(read_ninja_log(options.folders[0]).items()):
            if not output.startswith("/"):  # a path of this machine
                print(max(1, round(10 * seconds)), output)
        return
    for folder in options.folders:
        if not (folder / ".ninja_log").exists():
            sys.exit(f"{folder}/.ninja_log is missing: nothing was built there; run ./start or ./check")
        steps = read_ninja_log(folder)
        targets = Counter()
        for output, seconds in steps.items():
            targets[target_of(output)] += seconds
        print(f"{folder} (wall time of each step; steps run side by side)")
        table("targets", targets, options.top)
        table("steps", steps, options.top)
        table("tests", read_tests(folder), options.top)
    if options.headers:
        seconds, readings = measure_headers(ROOT / "build" / "analysis")
        table("headers", {f"{header} ({readings[header]} times)": took
                          for header, took in seconds.items()}, options.top)


if __name__ == "__main__":
    main()
