#!/usr/bin/env python3
"""Which tests of ./check have passed with the same program, data and environment.

usage: passed.py BUILD due KEY ...     prints the keys that must run, one a line
       passed.py BUILD keep KEY ...    remembers that these passed; not those that changed while they ran

A key is TEST=TARGET,...: the name of a test of ctest, of the pages or of the browser, and the targets that it runs.
The digest of a test has the contents of
  - the objects that its targets consist of, but for the one with the version of the sources, which every commit changes,
  - every file that git does not ignore, but for C++ sources, texts, scripts/ and, unless the test's name begins with a
    word of PAGES, the pages,
  - the names and versions of the installed packages, the compiler, node, the kernel,
  - the variables of the environment that tests read. The seed is none of them: a test that passed with another seed has
    passed. Who sets WHOLEHAND_SEED wants the tests to run: ./check then skips nothing.
"""
import hashlib
import os
import re
import subprocess
import sys
from functools import cache
from pathlib import Path

ROOT = Path(__file__).resolve().parents[1]
OBJECTS = re.compile(r"\.o$")
VERSION = "program_version.cpp.o"
PAGES = ("pages", "browser", "apps_")
VARIABLES = re.compile(r"^(WHOLEHAND_(?!SEED$)|[A-Z]*SAN_OPTIONS$|GTEST_|LANG$|LC_|TZ$)")


def lines_of(*command):
    done = subprocess.run(command, cwd=ROOT, capture_output=True, text=True, check=False)
    return done.stdout.splitlines()


@cache
def digest_of(path):
    return hashlib.sha256(path.read_bytes()).hexdigest() if path.is_file() else "none"


@cache
def objects_of(build, target):
    """Digest of the objects of a target."""
    names = sorted(name.strip() for name in lines_of("ninja", "-C", str(build), "-t", "inputs", target))
    found = [name for name in names if OBJECTS.search(name) and not name.endswith(VERSION)]
    return "".join(f"{name} {digest_of(build / name)}\n" for name in found)


@cache
def data(with_pages):
    names = sorted(lines_of("git", "ls-files", "-co", "--exclude-standard"))
    left_out = (".ci/", "docs/", "scripts/", "check", "start") + (() if with_pages else ("web/",))
    kept = [name for name in names if not name.startswith(left_out)
            and not name.endswith((".cpp", ".hpp", ".md", "CMakeLists.txt"))]
    return "".join(f"{name} {digest_of(ROOT / name)}\n" for name in kept)


@cache
def environment():
    variables = sorted(f"{name}={value}" for name, value in os.environ.items() if VARIABLES.match(name))
    packages = lines_of("dpkg-query", "-W", "-f=${Package} ${Version}\n")
    versions = [*lines_of("clang++", "--version"), *lines_of("node", "--version"), *lines_of("uname", "-rm")]
    return "\n".join([*variables, *packages, *versions, f"{os.cpu_count()} processors"])


def digest(build, key):
    name, _, targets = key.partition("=")
    parts = [name, environment(), data(name.startswith(PAGES))]
    parts += [objects_of(build, target) for target in targets.split(",") if target]
    return hashlib.sha256("\n".join(parts).encode()).hexdigest()


def main():
    if len(sys.argv) < 3 or sys.argv[2] not in ("due", "keep"):
        sys.exit(__doc__)
    build, keys = Path(sys.argv[1]).resolve(), sys.argv[3:]
    folder = build / "passed"
    folder.mkdir(exist_ok=True)
    for key in keys:
        note = folder / key.partition("=")[0].replace("/", "_")
        begun, now = note.with_suffix(".begun"), digest(build, key)
        if sys.argv[2] == "due":
            begun.write_text(now)
            if not note.is_file() or note.read_text() != now:
                print(key)
        elif begun.is_file() and begun.read_text() == now:
            note.write_text(now)


if __name__ == "__main__":
    main()
