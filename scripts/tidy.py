#!/usr/bin/env python3
"""Compiles every .cpp file of some folders by itself and runs clang-tidy over them.

usage: tidy.py BUILD_FOLDER JOBS FOLDER ...      exit code 0: clean, 1: faults, on stdout

The build joins sources and precompiles headers: a source that forgets an #include is found here. A
file that was clean is looked at again when it, a header of the repository that it reads, its
arguments or the rules have changed (BUILD_FOLDER/clean.json). What is clean is written there at
once: a run that was ended is gone on with.

Nearly all of clang-tidy's time goes into the headers of the language and of Eigen, which nearly
every file includes. Hence one run looks at a batch: a file that includes some thirty sources. Two
sources of which one uses a name of the other's anonymous namespace do not share a batch, and a source
with a private type or constant named as one of a header shares none. Of a batch
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
import threading
import time
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path

RULES = Path(__file__).resolve().parents[1] / ".clang-tidy"
BATCH = 32
FILTER = r"/(src|apps|drivers|include|experiments|clients/python/module)/.*\.[ch]pp$"
ANONYMOUS = re.compile(r"^namespace \{$(.*?)^\}  // namespace$", re.MULTILINE | re.DOTALL)
STATIC = re.compile(r"^(?:static|using) .*", re.MULTILINE)
NO_CODE = re.compile(r'//.*|"(?:[^"\\\n]|\\.)*"')
# What another source's private name could be taken for: a function that is called, a type, a constant;
# none of them a member.
USED = re.compile(r"(?<![\w.:>])(?:([a-z]\w*)\s*(?=\()|([A-Zk]\w*))")
MACRO = re.compile(r"^\s*#\s*define (\w+)", re.MULTILINE)
# clang-format puts what a namespace declares at the start of a line.
DECLARED = re.compile(r"^[A-Za-z][^\n({=;]*?\b([A-Za-z_]\w*)(?:\[\w*\])*\s*[({=;:]", re.MULTILINE)
CONSTANT = re.compile(r"\b(k[A-Z]\w*)\s*(?=(?:\[\w*\]\s*)*(?:=[^=]|\{))")
OF_NAMESPACE = re.compile(r"^(?:inline |static )*const.*", re.MULTILINE)
TYPE = re.compile(r"^(?:struct|class|union|enum(?: class)?) (\w+)|^using (\w+) =", re.MULTILINE)
ALIAS = re.compile(r"^\s*namespace (\w+) = ", re.MULTILINE)


def has_idle_alias(text):
    """Whether an alias of a namespace seems unused: clang-tidy is silent on that in a batch."""
    return any(not re.search(rf"\b{name}::", text) for name in ALIAS.findall(text))


def private_names(text):
    """Names that a source keeps to itself: no other source of its batch may have one of them."""
    parts = ANONYMOUS.findall(text) + [line + ";" for line in STATIC.findall(text)]
    names = {name for part in parts for name in DECLARED.findall(part) + CONSTANT.findall(part)}
    return names.union(MACRO.findall(text)) - {"std", "Eigen", "final"}


def used_names(text):
    return {name for names in USED.findall(NO_CODE.sub("", text)) for name in names if name}


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


def names_of_headers(folders):
    """Names of the types and constants of all headers."""
    texts = [header.read_text() for folder in folders for header in folder.rglob("*.hpp")]
    types = {name for text in texts for pair in TYPE.findall(text) for name in pair if name}
    constants = (line for text in texts for line in OF_NAMESPACE.findall(text))
    return types.union(*(CONSTANT.findall(line) for line in constants))


def make_batches(sources, public):
    """Lists of sources that can stand in one file, their private names do not collide; and sources
    that share none, since they have a name of `public` for themselves."""
    batches, alone, found = [], [], []
    for source in sorted(sources):
        text = source.read_text()
        header = source.with_suffix(".hpp")
        names = private_names(text)
        # extern "C": what takes the place of malloc, say.
        if 'extern "C"' in text or "\nusing namespace" in text or names & public:
            alone.append(source)
            continue
        used = used_names(text + (header.read_text() if header.exists() else ""))
        found.append((source, names, names | used))
    # Those with most private names are hardest to place, and come first.
    for source, names, used in sorted(found, key=lambda entry: -len(entry[1])):
        for batch in batches:
            if (len(batch["sources"]) < BATCH and not batch["names"] & used
                    and not batch["used"] & names):
                break
        else:
            batch = {"sources": [], "names": set(), "used": set()}
            batches.append(batch)
        batch["sources"].append(source)
        batch["names"] |= names
        batch["used"] |= used
    alone += [batch["sources"][0] for batch in batches if len(batch["sources"]) == 1]
    return [batch["sources"] for batch in batches if len(batch["sources"]) > 1], alone


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
    """Which sources have compiled alone, which were clean, and what they read then."""

    def __init__(self, build, commands):
        self.file, self.dependencies = build / "clean.json", build / "dependencies"
        self.dependencies.mkdir(exist_ok=True)
        self.commands, self.digests, self.lock = commands, {}, threading.Lock()
        try:
            known, names = json.loads(self.file.read_text()), {str(source) for source in commands}
            self.known = {kind: {name: key for name, key in known[kind].items() if name in names}
                          for kind in ("compiled", "clean")}
        except (OSError, ValueError, KeyError, TypeError, AttributeError):
            self.known = {"compiled": {}, "clean": {}}

    def depfile(self, source):
        name = hashlib.sha256(str(source).encode()).hexdigest()[:16]
        return self.dependencies / f"{name}.d"

    def digest(self, path, changed_ns):
        if (path, changed_ns) not in self.digests:
            self.digests[path, changed_ns] = hashlib.sha256(path.read_bytes()).hexdigest()
        return self.digests[path, changed_ns]

    def key(self, source, before=None):
        """Of all that the source was compiled from. None where it was never compiled, or where a file
        has changed since the time `before`."""
        try:
            words = self.depfile(source).read_text().replace("\\\n", " ").split()[1:]
            read = sorted({Path(w) for w in words if not w.startswith("/usr/")} | {source, RULES})
            changed_ns = {path: path.stat().st_mtime_ns for path in read}
            if before is not None and max(changed_ns.values()) >= before * 1e9:
                return None
            parts = [*self.commands[source],
                     *(f"{path}={self.digest(path, changed_ns[path])}" for path in read)]
        except OSError:
            return None
        return hashlib.sha256("\n".join(parts).encode()).hexdigest()

    def has(self, kind, source):
        return self.known[kind].get(str(source)) == self.key(source) is not None

    def keep(self, kind, sources, before):
        """What was found of these sources holds for the files as they were at the time `before`."""
        keys = {str(source): self.key(source, before) for source in sources}
        with self.lock:
            self.known[kind].update(keys)
            new = self.file.with_suffix(".new")
            new.write_text(json.dumps(self.known, indent=1))
            new.replace(self.file)


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
        if self.clean.has("compiled", source):
            return None
        command, started = self.clean.commands[source], time.time()
        shared = []
        if self.arguments_of(command) == self.fits and self.includes_eigen(source):
            shared = ["-include-pch", str(self.header)]
        words = words_of(run([*command, *shared, "-w", "-fsyntax-only", "-MD", "-MT", "x", "-MF",
                              str(self.clean.depfile(source)), str(source)], self.build))
        if words is None:
            self.clean.keep("compiled", [source], started)
        return words


def look_at(build, jobs, commands, clean, public):
    """{source: faults} of these commands. A batch takes the arguments of all sources."""
    place, single = build / "tidy", build / "tidy" / "alone"
    place.mkdir(exist_ok=True)
    batches, alone = make_batches(commands, public)
    files = [place / f"batch_{number}.cpp" for number in range(len(batches))]
    for file, sources in zip(files, batches):
        file.write_text("".join(f'#include "{source}"  // NOLINT\n' for source in sources))
    write_database(place, build, dict.fromkeys(files, together(clean.commands.values())))
    write_database(single, build, commands)

    def tidy_batch(file, sources):
        """The sources that have to be looked at alone."""
        started = time.time()
        said = tidy(place, file)
        unclear = [source for source in sources if said or has_idle_alias(source.read_text())]
        clean.keep("clean", set(sources) - set(unclear), started)
        return unclear

    def tidy_alone(source):
        started = time.time()
        said = tidy(single, source)
        if said is None:
            clean.keep("clean", [source], started)
        return said

    with ThreadPoolExecutor(jobs) as pool:
        for unclear in pool.map(tidy_batch, files, batches):
            alone += unclear
        faults = {source: words for source, words in zip(alone, pool.map(tidy_alone, alone)) if words}
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
    commands = {source: every[source] for source in every if not clean.has("clean", source)}
    alone = Alone(build, clean)
    with ThreadPoolExecutor(jobs) as pool:
        said = pool.map(alone.compile, commands)
        faults = {source: words for source, words in zip(commands, said) if words}
    how = "not looked at by clang-tidy"
    if not faults:  # what does not compile cannot be read
        faults, how = look_at(build, jobs, commands, clean, names_of_headers(folders))
    for words in faults.values():
        print(words)
    print(f"{len(commands)} files {how}, {len(every) - len(commands)} clean before, "
          f"{len(faults)} with faults")
    sys.exit(1 if faults else 0)


if __name__ == "__main__":
    main()
