#!/usr/bin/env python3
"""Every version that is written by hand is the project's, which CMakeLists.txt names.

usage: check_versions.py [ROOT]      exit code 0: all agree, 1: faults, one a line
"""
import re
import sys
from pathlib import Path

# Version of the project; the changelogs have a section for it.
PROJECT = ("CMakeLists.txt", r"^project\(wholehand VERSION ([0-9.]+)")
OTHERS = [
    ("CITATION.cff", r"^version: (.*)$"),
    ("clients/python/wholehand/__init__.py", r'^__version__ = "(.*)"$'),
    ("CHANGELOG.md", r"^## \[(?:Unreleased\]: )?([0-9.]+)"),
    ("web/package.json", r'^  "version": "(.*)",$'),
    ("clients/unity/org.wholehand.client/package.json", r'^  "version": "(.*)",$'),
    ("clients/unity/org.wholehand.client/CHANGELOG.md", r"^## \[([0-9.]+)\]"),
    ("clients/godot/addons/wholehand/plugin.cfg", r'^version="(.*)"$'),
]


def said(root, file, pattern):
    try:
        found = re.search(pattern, (root / file).read_text(encoding="utf-8"), re.M)
    except OSError as error:
        sys.exit(f"{root / file}: {error.strerror}")
    return found.group(1) if found else None


def faults_of(root):
    version = said(root, *PROJECT)
    for file, pattern in OTHERS:
        other = said(root, file, pattern)
        if other != version:
            yield f"{root / file}: the version is {other or 'missing'}, that of {root / PROJECT[0]} is {version}; write {version} there"


def main():
    if len(sys.argv) > 2:
        sys.exit(__doc__)
    root = Path(sys.argv[1]) if len(sys.argv) == 2 else Path(__file__).resolve().parents[1]
    faults = list(faults_of(root))
    print("\n".join(faults) or "versions agree")
    sys.exit(1 if faults else 0)


if __name__ == "__main__":
    main()
