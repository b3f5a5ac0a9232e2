#!/usr/bin/env python3
"""Compiles every .cpp file of some folders by itself and runs clang-tidy over them.

usage: tidy.py BUILD_FOLDER JOBS FOLDER ...      exit code 0: clean, 1: faults, on stdout

The build joins sources and precompiles headers: a source that forgets an #include is found here. A
file that was clean is looked at again when it, a header of the repository that it reads, its
arguments or the rules have changed (BUILD_FOLDER/clean.json).

Nearly all of clang-tidy's time goes into the headers of the language and of Eigen, which nearly
every file includes. Hence one run looks at a batch: a file that includes up to a dozen sources. Two
sources of which one uses a name of the other's anonymous namespace never share a batch. Of a batch
that is not clean every source is looked at alone, and only that counts: what is said here is what
clang-tidy says of each file by itself.
"""
import hashlib
import json
import re
import shlex
import signal
import subprocess
import sys
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path

RULES = Path(__file__).resolve().parents[1] / ".clang-tidy"
BATCH = 12
FILTER = r"/(src|apps|drivers|include|experiments)/.*\.[ch]pp$"
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
        if source.suffix == ".cpp" and any(source.is_relative_to(folder) for folder in folders):
            arguments = shlex.split(entry["command"])
            if Path(arguments[0]).name == "ccache":
                del arguments[0]
            # The first: tests compile some of these once more.
            commands.setdefault(source, arguments[:arguments.index("-o")])
    return commands


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


def words_of(done):
    """What a program says that did not end well; never empty. None where it ended well."""
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


def tidy(database, source):
    """What clang-tidy says of one file of a compile database; None where it is clean."""
    return words_of(run(["clang-tidy", "-p", str(database), "--quiet", f"--config-file={RULES}",
                         f"--header-filter={FILTER}", str(source)]))


class CleanFiles:
    """Which sources were clean, and what they read then."""

    def __init__(self, build, commands):
        self.file, self.dependencies = build / "clean.json", build / "dependencies"
        self.dependencies.mkdir(exist_ok=True)
        self.commands, self.texts = commands, {}
        try:
            self.known = json.loads(self.file.read_text())
        except (OSError, ValueError):
            self.known = {}

    def depfile(self, source):
        name = hashlib.sha256(str(source).encode()).hexdigest()[:16]
        return self.dependencies / f"{name}.d"

    def digest(self, path):
        if path not in self.texts:
            try:
                self.texts[path] = hashlib.sha256(path.read_bytes()).hexdigest()
            except OSError:
                self.texts[path] = "gone"
        return self.texts[path]

    def key(self, source):
        """None where it was never compiled."""
        try:
            words = self.depfile(source).read_text().replace("\\\n", " ").split()[1:]
        except OSError:
            return None
        read = sorted({Path(w) for w in words if not w.startswith("/usr/")} | {source, RULES})
        parts = [*self.commands[source], *(f"{path}={self.digest(path)}" for path in read)]
        return hashlib.sha256("\n".join(parts).encode()).hexdigest()

    def has(self, source):
        return self.known.get(str(source)) == self.key(source) is not None

    def keep(self, sources):
        self.known = {str(s): self.known[str(s)] for s in self.commands if str(s) in self.known}
        self.known.update({str(s): self.key(s) for s in sources})
        self.file.write_text(json.dumps(self.known, indent=1))


class Alone:
    """Compiles sources that nothing else stands beside. Most of that time went into Eigen, which most
    of them include one way or the other: these get it from a precompiled header, and no other does,
    so that who forgets an #include is still found."""

    INCLUDE = re.compile(r'^\s*#\s*include ["<]([^">]+)[">]', re.MULTILINE)

    def __init__(self, build, clean):
        self.build, self.clean, self.reads_eigen = build, clean, {}
        self.roots = [RULES.parent / folder for folder in ("src", "apps", "include", "")]
        self.header = build / "tidy" / "eigen.pch"
        self.header.parent.mkdir(exist_ok=True)
        first = next(iter(clean.commands.values()))
        self.fits = self.arguments_of(first)
        source = self.header.with_suffix(".hpp")
        source.write_text("#include <Eigen/Core>  // IWYU pragma: keep\n")
        done = run([*first, "-w", "-x", "c++-header", str(source), "-o", str(self.header)], build)
        if done.returncode != 0:
            self.fits = None

    @staticmethod
    def arguments_of(command):
        """What a precompiled header depends on: neither folders of headers nor our definitions."""
        kept, words = [], iter(command)
        for word in words:
            if word == "-isystem":
                next(words)
            elif not word.startswith(("-I", "-D")):
                kept.append(word)
        return kept

    def includes_eigen(self, path):
        if path not in self.reads_eigen:
            self.reads_eigen[path] = False  # ends a circle
            found = False
            for name in self.INCLUDE.findall(path.read_text()):
                inner = next((root / name for root in [path.parent, *self.roots]
                              if (root / name).is_file()), None)
                found = found or name.startswith("Eigen/") or (
                    inner is not None and self.includes_eigen(inner))
            self.reads_eigen[path] = found
        return self.reads_eigen[path]

    def compile(self, source):
        """What the compiler says of it; None where it is well."""
        command = self.clean.commands[source]
        shared = []
        if self.arguments_of(command) == self.fits and self.includes_eigen(source):
            shared = ["-include-pch", str(self.header)]
        return words_of(run([*command, *shared, "-w", "-fsyntax-only", "-MD", "-MT", "x", "-MF",
                             str(self.clean.depfile(source)), str(source)], self.build))


def look_at(build, jobs, commands, every):
    """{source: faults} of these commands; `every` holds all, whose arguments a batch takes."""
    place, single = build / "tidy", build / "tidy" / "alone"
    place.mkdir(exist_ok=True)
    batches = make_batches(commands)
    files = [place / f"batch_{number}.cpp" for number in range(len(batches))]
    for file, sources in zip(files, batches):
        file.write_text("".join(f'#include "{source}"  // NOLINT\n' for source in sources))
    write_database(place, build, dict.fromkeys(files, together(every.values())))
    write_database(single, build, commands)
    with ThreadPoolExecutor(jobs) as pool:
        said = list(pool.map(lambda file: tidy(place, file), files))
        alone = [source for words, sources in zip(said, batches) for source in sources
                 if words or has_idle_alias(source.read_text())]
        told = pool.map(lambda source: tidy(single, source), alone)
        faults = {source: words for source, words in zip(alone, told) if words}
    return faults, f"in {len(batches)} batches, {len(alone)} looked at alone"


def main():
    if len(sys.argv) < 4:
        sys.exit(__doc__)
    build, jobs = Path(sys.argv[1]).resolve(), int(sys.argv[2])
    folders = [Path(folder).resolve() for folder in sys.argv[3:]]
    every = read_commands(build, folders)
    unknown = {file for folder in folders for file in folder.rglob("*.cpp")} - every.keys()
    if unknown or not every:
        names = " ".join(str(file) for file in sorted(unknown)) or " ".join(sys.argv[3:])
        sys.exit(f"{build / 'compile_commands.json'} knows nothing of: {names}")
    clean = CleanFiles(build, every)
    commands = {source: every[source] for source in every if not clean.has(source)}
    alone = Alone(build, clean)
    with ThreadPoolExecutor(jobs) as pool:
        said = pool.map(alone.compile, commands)
        faults = {source: words for source, words in zip(commands, said) if words}
    how = "not looked at by clang-tidy"
    if not faults:  # what does not compile cannot be read
        faults, how = look_at(build, jobs, commands, every)
    clean.keep(commands.keys() - faults.keys() if "batches" in how else [])
    for words in faults.values():
        print(words)
    print(f"{len(commands)} files {how}, {len(every) - len(commands)} clean before, "
          f"{len(faults)} with faults")
    sys.exit(1 if faults else 0)


if __name__ == "__main__":
    main()
