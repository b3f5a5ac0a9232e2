#!/usr/bin/env python3
"""Runs clang-tidy over every .cpp file of some folders, each by itself.

usage: tidy.py [--changed] BUILD_FOLDER JOBS FOLDER ...      exit code 0: clean, 1: faults, on stdout

--changed: only what was changed, or reads a header that was changed, since the commit in
scripts/clean_commit; everything where the rules have changed or the commit is not known.

The build joins sources and precompiles headers: a source that forgets an #include is found here. A
file that was clean is looked at again when it, a header of the repository that it reads, its
arguments or the rules have changed (BUILD_FOLDER/clean.json). What is clean is written there at
once: a run that was ended is gone on with.

Three things keep it fast. scripts/tidy_own_declarations.cpp keeps the checks out of the headers of
others, where nearly all of clang-tidy's time went. A source gets from a precompiled header those
headers of others that it includes anyway, and no further ones. And modules of C++20, which nothing
here uses, are off: where they are on, clang-tidy 14 reads every header a second time, by a
preprocessor of its own.
"""
import hashlib
import json
import re
import shlex
import signal
import subprocess
import sys
import threading
import time
from collections import Counter
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path
from shutil import which

import changes

ROOT = Path(__file__).resolve().parents[1]
RULES = ROOT / ".clang-tidy"
PLUGIN = Path(__file__).with_name("tidy_own_declarations.cpp")
FILTER = r"/(src|apps|drivers|include|experiments|lab|clients/python/module)/.*\.[ch]pp$"
INCLUDE = re.compile(r'^\s*#\s*include ["<]([^">]+)[">]', re.MULTILINE)
# Third-party headers that take long to read.
LONG = ("Eigen/Core", "Eigen/Geometry", "fmt/format.h", "nlohmann/json.hpp", "CLI/CLI.hpp", "hdf5.h",
        "pybind11/pybind11.h")
NO_MODULES = ("-Xclang", "-fno-cxx-modules")
SHARED_BY = 4  # number of sources that makes a precompiled header worth its time


def read_commands(build, folders):
    """{source: compiler arguments without source and object} for the given folders."""
    commands = {}
    for entry in json.loads((build / "compile_commands.json").read_text()):
        source = Path(entry["file"])
        if source.suffix == ".cpp" and any(source.is_relative_to(folder) for folder in folders):
            arguments = shlex.split(entry["command"])
            if Path(arguments[0]).name == "ccache":
                del arguments[0]
            # Keeps the first command, because tests compile some of these sources again.
            commands.setdefault(source, [*arguments[:arguments.index("-o")], *NO_MODULES])
    return commands


def words_of(done):
    """Output of a program that failed, never empty; None when it succeeded."""
    if done.returncode == 0:
        return None
    said = (done.stdout or "") + (done.stderr or "")
    if done.returncode < 0:
        name = signal.Signals(-done.returncode).name
        said += f"error: {done.args[0]} was ended by {name} (out of memory?): {done.args[-1]}\n"
    return said or f"error: {done.args[0]} ended with {done.returncode}: {done.args[-1]}\n"


def run(arguments, folder=None):
    return subprocess.run(arguments, cwd=folder, stdout=subprocess.PIPE, stderr=subprocess.PIPE,
                          text=True, check=False)


class Includes:
    """Includes of files, read from their text, also inside #if."""

    def __init__(self):
        self.known, self.lock = {}, threading.RLock()

    def of(self, path, folders):
        """(headers of the repository, third-party headers) that a file includes, directly or indirectly."""
        with self.lock:
            if path not in self.known:
                self.known[path] = (set(), set())  # ends a cycle
                own, others = set(), set()
                for name in INCLUDE.findall(path.read_text()):
                    inner = next((folder / name for folder in (path.parent, *folders)
                                  if (folder / name).is_file()), None)
                    if inner is None:
                        others.add(name)
                        continue
                    deeper = self.of(inner, folders)
                    own |= {inner} | deeper[0]
                    others |= deeper[1]
                self.known[path] = (own, others)
            return self.known[path]


def own_folders(command, source):
    """Include folders of the repository in a compiler's arguments."""
    folders = [Path(word[2:]) for word in command if word.startswith("-I")]
    return [folder for folder in folders if folder.is_relative_to(ROOT) or folder in source.parents]


class CleanFiles:
    """The clean sources, with digests of all files that they include."""

    def __init__(self, build, commands, includes):
        self.file, self.commands, self.includes = build / "clean.json", commands, includes
        self.digests, self.lock = {}, threading.Lock()
        try:
            known, names = json.loads(self.file.read_text()), {str(source) for source in commands}
            self.known = {name: key for name, key in known.items() if name in names}
        except (OSError, ValueError, AttributeError):
            self.known = {}

    def digest(self, path, changed_ns):
        if (path, changed_ns) not in self.digests:
            self.digests[path, changed_ns] = hashlib.sha256(path.read_bytes()).hexdigest()
        return self.digests[path, changed_ns]

    def key(self, source, before=None):
        """Digest of the source, its headers and arguments. None when a file has changed since the time `before`."""
        command = self.commands[source]
        try:
            own, _ = self.includes.of(source, own_folders(command, source))
            read = sorted(own | {source, RULES, PLUGIN})
            changed_ns = {path: path.stat().st_mtime_ns for path in read}
            if before is not None and max(changed_ns.values()) >= before * 1e9:
                return None
            parts = [*command, *(f"{path}={self.digest(path, changed_ns[path])}" for path in read)]
        except OSError:
            return None
        return hashlib.sha256("\n".join(parts).encode()).hexdigest()

    def has(self, source):
        return self.known.get(str(source)) == self.key(source) is not None

    def keep(self, source, before):
        """Records that the source was clean, with its files as they were at the time `before`."""
        key = self.key(source, before)
        with self.lock:
            self.known[str(source)] = key
            new = self.file.with_suffix(".new")
            new.write_text(json.dumps(self.known, indent=1))
            new.replace(self.file)


def build_plugin(folder):
    """The plugin of clang-tidy; built again when its source is newer."""
    plugin = folder / "own_declarations.so"
    headers = Path(which("clang-tidy")).resolve().parents[1] / "include"
    if not plugin.exists() or plugin.stat().st_mtime < PLUGIN.stat().st_mtime:
        if not (headers / "clang-tidy").is_dir():
            sys.exit(f"{headers} has no headers of clang-tidy: apt-get install libclang-14-dev")
        new = plugin.with_suffix(".new")
        said = words_of(run(["clang++", "-std=c++17", "-O1", "-shared", "-fPIC", "-fno-rtti", "-isystem",
                             str(headers), str(PLUGIN), "-o", str(new)]))
        if said:
            sys.exit(said)
        new.replace(plugin)
    return plugin


def arguments_for_precompiled(command):
    """Compiler arguments that affect a precompiled header: all but include folders and definitions."""
    kept, words = [], iter(command)
    for word in words:
        if word == "-isystem":
            next(words)
        elif not word.startswith(("-I", "-D")):
            kept.append(word)
    return tuple(kept)


class Precompiled:
    """Precompiled third-party headers: one file for each set of headers that several sources include."""

    def __init__(self, folder, jobs, commands, includes):
        self.selections = {
            source: (arguments_for_precompiled(command), frozenset(
                name for name in includes.of(source, own_folders(command, source))[1] if name in LONG))
            for source, command in commands.items()}
        wanted = [key for key, count in Counter(self.selections.values()).items()
                  if count >= SHARED_BY and key[1]]
        first = {key: next(source for source in commands if self.selections[source] == key)
                 for key in wanted}
        with ThreadPoolExecutor(jobs) as pool:
            files = pool.map(lambda key: self.make(folder, key, commands[first[key]]), wanted)
            self.files = {key: file for key, file in zip(wanted, files) if file}

    @staticmethod
    def make(folder, key, command):
        name = hashlib.sha256(repr((key[0], sorted(key[1]))).encode()).hexdigest()[:12]
        source, file = folder / f"{name}.hpp", folder / f"{name}.pch"
        source.write_text("".join(f"#include <{header}>  // IWYU pragma: keep\n"
                                  for header in LONG if header in key[1]))
        done = run([*command, "-w", "-x", "c++-header", str(source), "-o", str(file)], folder)
        return file if done.returncode == 0 else None

    def arguments(self, source):
        """-include-pch with the largest set that contains only headers that the source includes."""
        arguments, headers = self.selections[source]
        fitting = [key for key in self.files if key[0] == arguments and key[1] <= headers]
        if not fitting:
            return []
        largest = max(fitting, key=lambda key: (len(key[1]), sorted(key[1])))
        return ["-include-pch", str(self.files[largest])]


def look_at(build, jobs, commands, clean, includes):
    """{source: faults} found by these commands."""
    folder = build / "tidy"
    folder.mkdir(exist_ok=True)
    plugin = build_plugin(folder)
    precompiled = Precompiled(folder, jobs, commands, includes)
    rules = folder / "rules.yaml"
    rules.write_text(RULES.read_text().replace("-*,", "-*,wholehand-own-declarations,", 1))

    def tidy(source):
        started = time.time()
        command = commands[source]
        said = words_of(run(["clang-tidy", "--load", str(plugin), "--quiet", f"--config-file={rules}",
                             f"--header-filter={FILTER}", str(source), "--", *command[1:],
                             *precompiled.arguments(source)], build))
        if said is None:
            clean.keep(source, started)
        return said

    with ThreadPoolExecutor(jobs) as pool:
        return {source: said for source, said in zip(commands, pool.map(tidy, commands)) if said}


def sources_changed(every, includes):
    """Those of these sources that changed since everything was clean."""
    names = changes.changed_files("tidy")
    if names is None:
        return set(every)
    changed = {ROOT / name for name in names}
    if not changed.isdisjoint({RULES, PLUGIN, Path(__file__).resolve()}) or any(name.startswith("protocol/") for name in names):
        return set(every)
    return {source for source, command in every.items()
            if source in changed or not changed.isdisjoint(includes.of(source, own_folders(command, source))[0])}


def main():
    arguments = sys.argv[1:]
    only_changed = arguments[:1] == ["--changed"]
    if only_changed:
        del arguments[0]
    if len(arguments) < 3:
        sys.exit(__doc__)
    build, jobs = Path(arguments[0]).resolve(), int(arguments[1])
    folders = [Path(folder).resolve() for folder in arguments[2:]]
    every = read_commands(build, folders)
    unknown = {file for folder in folders for file in folder.rglob("*.cpp")
               if "tests" not in file.relative_to(folder).parts} - every.keys()
    if unknown or not every:
        names = " ".join(str(file) for file in sorted(unknown)) or " ".join(arguments[2:])
        sys.exit(f"{build / 'compile_commands.json'} knows nothing of: {names}")
    includes = Includes()
    clean = CleanFiles(build, every, includes)
    wanted = sources_changed(every, includes) if only_changed else set(every)
    commands = {source: every[source] for source in every if source in wanted and not clean.has(source)}
    faults = look_at(build, jobs, commands, clean, includes) if commands else {}
    for words in faults.values():
        print(words)
    print(f"{len(commands)} files looked at, {len(every) - len(commands)} clean before, "
          f"{len(faults)} with faults")
    sys.exit(1 if faults else 0)


if __name__ == "__main__":
    main()
