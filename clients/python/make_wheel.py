#!/usr/bin/env python3
"""make_wheel.py PROJECT OUT: the wheel and the sdist of a built package (build/release/python), in the folder OUT.

Works in a copy: setuptools leaves its files in the folder of the project.
"""
import os
import pathlib
import shutil
import sys
import tempfile

from setuptools import build_meta


def make(project, out):
    out.mkdir(parents=True, exist_ok=True)
    with tempfile.TemporaryDirectory() as folder:
        copy = pathlib.Path(folder) / "project"
        shutil.copytree(project, copy, ignore=shutil.ignore_patterns("__pycache__", "*.egg-info", "build"))
        os.chdir(copy)
        names = build_meta.build_sdist(str(out)), build_meta.build_wheel(str(out))
    return [out / name for name in names]


def main():
    if len(sys.argv) != 3:
        sys.exit(__doc__)
    print("\n".join(map(str, make(*(pathlib.Path(argument).resolve() for argument in sys.argv[1:])))))


if __name__ == "__main__":
    main()
