#!/usr/bin/env python3
"""Begins a new exercise from the one that ships as the template (docs/exercises.md).

scripts/new_exercise.py my-task [--into FOLDER]

Copies src/exercises/squeeze_to_level, its exercise file and its scene under the new name, and prints
what it made. --into: the root of another tree than this one. Nothing that is there is written over.
"""
import argparse
import pathlib
import re
import sys

TEMPLATE = "squeeze-to-level"
ROOT = pathlib.Path(__file__).resolve().parent.parent


def renamed(text: str, name: str) -> str:
    """The template's text under another name: files, namespace, class, "kind" and "name"."""
    def camel(words: str) -> str:
        return "".join(word.capitalize() for word in words.split("-"))
    for old, new in ((TEMPLATE, name), (TEMPLATE.replace("-", "_"), name.replace("-", "_")),
                     (camel(TEMPLATE), camel(name))):
        text = text.replace(old, new)
    return text


def copies(name: str) -> dict[pathlib.Path, pathlib.Path]:
    """Pairs of a file of this repository and the file of the tree to which it is copied."""
    sources = [*sorted((ROOT / "src/exercises" / TEMPLATE.replace("-", "_")).iterdir()),
               ROOT / f"config/exercises/{TEMPLATE}.toml", ROOT / f"config/scenes/{TEMPLATE}.toml"]
    return {path: pathlib.Path(renamed(str(path.relative_to(ROOT)), name)) for path in sources}


def main() -> int:
    parser = argparse.ArgumentParser(description=__doc__.split("\n\n")[0])
    parser.add_argument("name", help="of the exercise: small letters, digits and hyphens")
    parser.add_argument("--into", type=pathlib.Path, default=ROOT, help="root of another tree")
    options = parser.parse_args()
    if not re.fullmatch(r"[a-z][a-z0-9]*(-[a-z0-9]+)*", options.name):
        print(f"new_exercise.py: \"{options.name}\" is no name; write small letters, digits and "
              "hyphens, as my-task", file=sys.stderr)
        return 2
    wanted = copies(options.name)
    taken = [str(path) for path in wanted.values() if (options.into / path).exists()]
    if taken:
        print(f"new_exercise.py: there already: {', '.join(taken)}; take another name",
              file=sys.stderr)
        return 2
    for source, target in wanted.items():
        path = options.into / target
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_text(renamed(source.read_text(), options.name))
        print(target)
    return 0


if __name__ == "__main__":
    sys.exit(main())
