"""Every guard of the station's decisions is found by the tests of the decisions.

A guard is an `if` whose body returns. One program is built in which each guard can be taken
away by its number; without a guard the tests must fail. Run by ctest in --full:
    python3 tests/station/guards_are_found.py build/release [NUMBER ...]
"""

import os
import pathlib
import re
import shlex
import subprocess
import sys
import tempfile

HOUSE = pathlib.Path(__file__).resolve().parents[2]
FILES = ["basis", "decide_orders", "decide_starts", "decide_turns", "press_permit", "stop_history"]
TESTS = "-*_slow*:*FileName*"
RETURNS = re.compile(r"\{?\s*(//[^\n]*\s*)*return\b(?! (\{true|Flaw::kNone))")
SWITCH = """#pragma once
#include <cstdlib>
/// False for the guard that is taken away.
inline bool keepsGuard(int number) {
  static const char* const without = std::getenv("WITHOUT_GUARD");
  return without == nullptr || std::atoi(without) != number;
}
"""


def end_of(text, start):
    """Index of the parenthesis that closes the one at start."""
    depth = 0
    for at in range(start, len(text)):
        depth += {"(": 1, ")": -1}.get(text[at], 0)
        if depth == 0:
            return at
    raise ValueError("a parenthesis does not close")


def switchable(text, guards, name):
    """The text with a switch in each guard; appends (file, line, condition) to guards."""
    parts, done = [], 0
    for found in re.finditer(r"\bif (?=\()", text):
        start, end = found.end(), end_of(text, found.end())
        if not RETURNS.match(text[end + 1 :].lstrip()):
            continue
        condition = text[start + 1 : end]
        opens = start + 1 + (condition.rfind(";") + 1)
        line = text.count("\n", 0, start) + 1
        parts += [text[done:opens], f" keepsGuard({len(guards)}) && ({text[opens:end].strip()})"]
        done = end
        guards.append((name, line, " ".join(text[opens:end].split())))
    return "".join(parts) + text[done:]


def commands(build):
    """What compiles the station, a unit each, and what links the tests."""
    listed = subprocess.run(
        ["ninja", "-C", build, "-t", "commands", "test_station"], check=True, capture_output=True, text=True
    )
    lines = listed.stdout.splitlines()
    station = re.compile(r" -o (src/station/CMakeFiles/wholehand_station\.dir/\S+)")
    return [line for line in lines if station.search(line)], lines[-1]


def build_switchable(build, folder):
    """Builds the tests with switchable guards in folder. Returns the program and its guards."""
    guards = []
    copies = {}
    for name in FILES:
        source = HOUSE / "src/station" / f"{name}.cpp"
        copies[source] = folder / source.name
        copies[source].write_text(switchable(source.read_text(), guards, f"src/station/{source.name}"))
    (folder / "switch.hpp").write_text(SWITCH)
    compiles, links = commands(build)
    archive = folder / "libwholehand_station.a"
    steps = [f"cp src/station/libwholehand_station.a {archive}"]
    for command in compiles:
        unit = pathlib.Path(shlex.split(command)[-1])
        text = unit.read_text()
        for source, copy in copies.items():
            text = text.replace(f'"{source}"', f'"{copy}"')
        if text == unit.read_text():
            continue
        (folder / unit.name).write_text(text)
        made = folder / f"{unit.name}.o"
        command = re.sub(r" -o \S+", f" -o {made} -include {folder}/switch.hpp", command)
        command = re.sub(r" -MF \S+| -MT \S+| -MD", "", command)
        steps += [command.replace(str(unit), str(folder / unit.name)), f"ar r {archive} {made}"]
    links = re.sub(r"(\S*/)?src/station/libwholehand_station\.a", str(archive), links)
    program = folder / "test_station"
    steps += [links.replace(" -o test_station ", f" -o {program} ")]
    for step in steps:
        subprocess.run(["bash", "-c", step], check=True, cwd=build)
    return program, guards


def first_failure(program, number):
    """Name of a test that fails without the guard, or None."""
    environment = dict(os.environ, WITHOUT_GUARD=str(number), WHOLEHAND_REDUCED_COUNTS="1")
    run = subprocess.run(
        [program, f"--gtest_filter={TESTS}", "--gtest_fail_fast", "--gtest_color=no"],
        capture_output=True,
        text=True,
        errors="replace",
        env=environment,
        timeout=600,
    )
    failed = re.search(r"\[  FAILED  \] (\S+)", run.stdout)
    if failed:
        return failed[1].rstrip(",")
    return None if run.returncode == 0 else f"ended with {run.returncode}"


def main(arguments):
    build = pathlib.Path(arguments[0]).resolve()
    with tempfile.TemporaryDirectory() as made:
        program, guards = build_switchable(build, pathlib.Path(made))
        if first_failure(program, -1):
            raise SystemExit(f"fails with every guard: {first_failure(program, -1)}")
        unseen = []
        for number in [int(a) for a in arguments[1:]] or range(len(guards)):
            name, line, condition = guards[number]
            failed = first_failure(program, number)
            print(f"{name}:{line}: {condition}: {failed or 'NOT FOUND'}", flush=True)
            if failed is None:
                unseen.append(number)
    print(f"{len(guards)} guards, {len(unseen)} not found")
    return 1 if unseen else 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
