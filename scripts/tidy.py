#!/usr/bin/env python3
"""Runs clang-tidy over every .cpp file of some folders, many files at a time.

usage: tidy.py BUILD_FOLDER JOBS FOLDER ...      exit code 0: clean, 1: faults, on stdout

Nearly all of clang-tidy's time goes into the headers of the language and of Eigen, which nearly
every file includes. Hence one run looks at a batch: a file that includes up to a dozen sources. Two
sources of which one uses a name of the other's anonymous namespace never share a batch. Of a batch
that is not clean every source is looked at alone, and only that counts: what is said here is what
clang-tidy says of each file by itself.
"""
import json
import re
import shlex
import subprocess
import sys
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path

RULES = Path(__file__).resolve().parents[1] / ".clang-tidy"
BATCH = 12
FILTER = r"/(src|apps|include|experiments)/.*\.[ch]pp$"
ANONYMOUS = re.compile(r"^namespace \{$(.*?)^\}  // namespace$", re.MULTILINE | re.DOTALL)
STATIC = re.compile(r"^(?:static|using) .*", re.MULTILINE)
WORD = re.compile(r"\w+")
MACRO = re.compile(r"^\s*#\s*define (\w+)", re.MULTILINE)
# clang-format puts what a namespace declares at the start of a line.
DECLARED = re.compile(r"^[A-Za-z][^\n({=;]*?\b([A-Za-z_]\w*)(?:\[\w*\])*\s*[({=;:]", re.MULTILINE)
ALIAS = re.compile(r"^\s*namespace (\w+) = ", re.MULTILINE)


def has_idle_alias(text):
    """Whether an alias of a namespace seems unused: clang-tidy is silent on that in a batch."""
    return any(not re.search(rf"\b{name}::", text) for name in ALIAS.findall(text))


def private_names(text):
    """Names that a source keeps to itself: no other source of its batch may have one of them."""
    parts = ANONYMOUS.findall(text) + [line + ";" for line in STATIC.findall(text)]
    names = {name for part in parts for name in DECLARED.findall(part)}
    return names.union(MACRO.findall(text)) - {"std"}


def read_commands(build, folders):
    """{source: arguments without the source and the object} of the given folders."""
    commands = {}
    for entry in json.loads((build / "compile_commands.json").read_text()):
        source = Path(entry["file"])
        if any(source.is_relative_to(folder) for folder in folders):
            arguments = shlex.split(entry["command"])
            if Path(arguments[0]).name == "ccache":
                del arguments[0]
            # The first: tests compile some of these once more.
            commands.setdefault(source, without_precompiled(arguments[:arguments.index("-o")]))
    return commands


def without_precompiled(arguments):
    """Headers that the build's own compiler has precompiled are none that another one can read."""
    rest, kept = iter(arguments), []
    for argument in rest:
        if argument == "-include":
            header = next(rest)
            kept += [] if "cmake_pch" in header else [argument, header]
        elif argument != "-Winvalid-pch":
            kept.append(argument)
    return kept


def write_database(folder, build, commands):
    """A compile database of these files alone, {file: arguments}."""
    folder.mkdir(exist_ok=True)
    entries = [{"directory": str(build), "file": str(file), "arguments": [*arguments, "-c", str(file)]}
               for file, arguments in commands.items()]
    (folder / "compile_commands.json").write_text(json.dumps(entries, indent=1))


def together(commands):
    """Arguments that fit every source: folders of headers and definitions of all."""
    every = []
    for arguments in commands:
        rest = iter(arguments)
        for argument in rest:
            words = [argument, next(rest)] if argument == "-isystem" else [argument]
            if words not in every:
                every.append(words)
    return [word for words in every for word in words]


def make_batches(sources):
    """Lists of sources that can stand in one file: their private names do not collide."""
    batches = []
    for source in sorted(sources):
        text = source.read_text()
        header = source.with_suffix(".hpp")
        seen = text + (header.read_text() if header.exists() else "")
        names, words = private_names(text), set(WORD.findall(seen))
        alone = 'extern "C"' in text  # what takes the place of malloc, say
        for batch in batches:
            if (not alone and len(batch["sources"]) < batch["room"]
                    and not batch["names"] & words and not batch["words"] & names):
                break
        else:
            batch = {"sources": [], "names": set(), "words": set(), "room": 1 if alone else BATCH}
            batches.append(batch)
        batch["sources"].append(source)
        batch["names"] |= names
        batch["words"] |= words
    return [batch["sources"] for batch in batches]


def tidy(database, source):
    """What clang-tidy says of one file of a compile database; empty where it is clean."""
    done = subprocess.run(
        ["clang-tidy", "-p", str(database), "--quiet", f"--config-file={RULES}",
         f"--header-filter={FILTER}", str(source)],
        stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True, check=False)
    return "" if done.returncode == 0 else done.stdout or done.stderr


def main():
    if len(sys.argv) < 4:
        sys.exit(__doc__)
    build, jobs = Path(sys.argv[1]).resolve(), int(sys.argv[2])
    folders = [Path(folder).resolve() for folder in sys.argv[3:]]
    commands = read_commands(build, folders)
    unknown = {file for folder in folders for file in folder.rglob("*.cpp")} - commands.keys()
    if unknown or not commands:
        names = " ".join(str(file) for file in sorted(unknown)) or " ".join(sys.argv[3:])
        sys.exit(f"{build / 'compile_commands.json'} knows nothing of: {names}")
    batches = make_batches(commands)

    place, single = build / "tidy", build / "tidy" / "alone"
    place.mkdir(exist_ok=True)
    arguments = together(commands.values())
    files = [place / f"batch_{number}.cpp" for number in range(len(batches))]
    for file, sources in zip(files, batches):
        file.write_text("".join(f'#include "{source}"  // NOLINT\n' for source in sources))
    write_database(place, build, dict.fromkeys(files, arguments))
    write_database(single, build, commands)

    with ThreadPoolExecutor(jobs) as pool:
        said = pool.map(lambda file: tidy(place, file), files)
        alone = [source for words, sources in zip(said, batches) for source in sources
                 if words or has_idle_alias(source.read_text())]
        faults = [words for words in pool.map(lambda source: tidy(single, source), alone) if words]
    for words in faults:
        print(words)
    print(f"{len(commands)} files in {len(batches)} batches, {len(alone)} looked at alone, "
          f"{len(faults)} with faults")
    sys.exit(1 if faults else 0)


if __name__ == "__main__":
    main()
