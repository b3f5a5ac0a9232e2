#!/usr/bin/env python3
"""Removes each guard of the station's decisions in turn and prints the law that notices.

usage: mutate_decisions.py [--jobs N] [--only TEXT]        needs build/release with test_station

A guard is an `if` of src/station/decide_*.cpp whose body returns. Its condition becomes false, the
decisions are compiled anew beside the build, and the tests Decide* run with small counts. Exits with
1 when a guard is missed; some are, since another one refuses the same (docs/adr/0078).
"""
import argparse
import os
import re
import shlex
import subprocess
import sys
import tempfile
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]
BUILD = ROOT / "build" / "release"
SOURCES = ["decide_orders.cpp", "decide_starts.cpp", "decide_turns.cpp"]
TESTS = "Decide*:-*_slow*"
RETURNS = re.compile(r"\s*\{?\s*(?://[^\n]*\s*)?return\b")


def closing(text, start):
    """Index behind the parenthesis that closes the one at start."""
    depth = 0
    for i in range(start, len(text)):
        depth += {"(": 1, ")": -1}.get(text[i], 0)
        if depth == 0:
            return i + 1
    raise ValueError("unbalanced")


def guards(source):
    """(line, condition, mutated text) of every `if` whose body begins with a return."""
    text = (ROOT / "src" / "station" / source).read_text()
    found = []
    for match in re.finditer(r"\bif \(", text):
        end = closing(text, match.end() - 1)
        if not RETURNS.match(text[end:]):
            continue
        inside = text[match.end():end - 1]
        declared, _, condition = inside.rpartition("; ")
        mutated = f"{declared}; false && ({condition})" if declared else f"false && ({condition})"
        line = text.count("\n", 0, match.start()) + 1
        found.append((line, " ".join(inside.split()),
                      text[:match.end()] + mutated + text[end - 1:]))
    return found


def commands():
    listed = subprocess.run(["ninja", "-C", BUILD, "-t", "commands", "test_station"],
                            capture_output=True, text=True, check=True).stdout.splitlines()
    archive = "src/station/libwholehand_station.a"
    compiles = [c for c in listed if "/wholehand_station.dir/" in c and " -c " in c]
    link = next(c for c in listed if re.search(r" -o \S*test_station\b", c) and " -c " not in c)
    return archive, compiles, link


def unity_of(command):
    words = shlex.split(command)
    return words, Path(words[words.index("-c") + 1])


def try_guard(source, mutated):
    """Output of the tests with one source replaced."""
    archive, compiles, link = commands()
    path = str(ROOT / "src" / "station" / source)
    with tempfile.TemporaryDirectory() as place:
        (Path(place) / source).write_text(mutated)
        objects = []
        for command in compiles:
            words, unity = unity_of(command)
            output = BUILD / words[words.index("-o") + 1]
            text = unity.read_text()
            if path in text or str(unity) == path:
                output = Path(place) / "mutant.o"
                changed = Path(place) / "unity.cxx"
                changed.write_text(text.replace(path, str(Path(place) / source)) if path in text
                                   else mutated)
                words[words.index("-c") + 1] = str(changed)
                words[words.index("-o") + 1] = str(output)
                for flag in ("-MF", "-MT"):
                    if flag in words:
                        words[words.index(flag) + 1] = str(Path(place) / "depends")
                built = subprocess.run([*words, "-w", "-O1"], cwd=BUILD, capture_output=True, text=True)
                if built.returncode:
                    return "does not compile: " + built.stderr[:300]
            objects.append(str(output))
        changed_archive = Path(place) / "station.a"
        subprocess.run(["ar", "qc", changed_archive, *objects], check=True)
        words = shlex.split(link.removeprefix(": && ").removesuffix(" && :"))
        words = [str(changed_archive) if w.endswith(archive) else w for w in words]
        program = Path(place) / "mutant"
        words[words.index("-o") + 1] = str(program)
        subprocess.run(words, cwd=BUILD, check=True)
        ran = subprocess.run([program, f"--gtest_filter={TESTS}", "--gtest_fail_fast"], capture_output=True, text=True,
                             env={**os.environ, "WHOLEHAND_REDUCED_COUNTS": "1"}, timeout=900)
        return ran.stdout if ran.returncode else ""


def read_laws():
    """What World says of a broken law."""
    text = "".join((ROOT / "tests" / "station" / f"decide_world.{ending}").read_text() for ending in ("cpp", "hpp"))
    calls = (text[m.end() - 1:closing(text, m.end() - 1)] for m in re.finditer(r"\blaw\(", text))
    return {words for call in calls for words in re.findall(r'"([^"]{8,})"', call)}


def first_law(output):
    """The law that the first failure names, else the first failed test; a crash is found, too."""
    named = [(output.find(law), law) for law in read_laws() if law in output]
    failed = re.search(r"\[  FAILED  \] (\S+)", output)
    return min(named)[1] if named else failed[1] if failed else "the program ends"


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--jobs", type=int, default=os.cpu_count())
    parser.add_argument("--only", default="", help="guards whose file:line or text holds this")
    arguments = parser.parse_args()
    listed = [(source, *guard) for source in SOURCES for guard in guards(source)]
    listed = [g for g in listed if arguments.only in f"{g[0]}:{g[1]} {g[2]}"]
    missed = 0
    with ThreadPoolExecutor(arguments.jobs) as pool:
        for (source, line, text, _), output in zip(
                listed, pool.map(lambda g: try_guard(g[0], g[3]), listed)):
            missed += not output
            print(f"{source}:{line}\t{text[:90]}\t{first_law(output) if output else 'MISSED'}",
                  flush=True)
    print(f"{len(listed)} guards, {len(listed) - missed} found, {missed} missed")
    sys.exit(missed > 0)


if __name__ == "__main__":
    main()
