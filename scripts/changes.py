#!/usr/bin/env python3
"""What has changed since the last commit at which a part of ./check found everything clean (scripts/clean_commit).

usage: changes.py tidy           names the files, one a line; exit code 3: that commit is not known here
       changes.py threads        those that lie where threads are; exit code 3 as above
       changes.py keep PART      says that this commit is clean by that part; refused where something is not committed

`./check --full` looks at everything. `./check` looks at what has changed since the commit that was kept.
"""
import re
import subprocess
import sys
from pathlib import Path

ROOT = Path(__file__).resolve().parents[1]
CLEAN = ROOT / "scripts/clean_commit"
THREADS = re.compile(r'#include (<(thread|mutex|atomic|condition_variable|shared_mutex|future)>|"loop/realtime/spsc_queue\.hpp")')
# A change of these files changes the compilation of every source.
OF_EVERY_SOURCE = ("CMakeLists.txt", "CMakePresets.json", "cmake/", "protocol/")


def git(*arguments):
    done = subprocess.run(["git", *arguments], cwd=ROOT, text=True, capture_output=True, check=False)
    return done.stdout.splitlines() if done.returncode == 0 else None


def clean_commits():
    """{part: commit at which it was clean}"""
    return dict(line.split() for line in CLEAN.read_text().splitlines()) if CLEAN.exists() else {}


def changed_files(part):
    """Changed paths relative to the root, also uncommitted ones. None when the clean commit is unknown."""
    commit = clean_commits().get(part)
    if commit is None:
        return None
    changed, new = git("diff", "--name-only", "--no-renames", commit), git("ls-files", "-o", "--exclude-standard")
    return None if changed is None or new is None else set(changed) | set(new)


def where_threads_are():
    """Folders with a source or header that starts threads, locks, or shares data."""
    return {path.parent for folder in ("src", "drivers", "clients/python/module", "tests")
            for path in (ROOT / folder).rglob("*.[ch]pp") if THREADS.search(path.read_text())}


def is_for_threads(name, folders):
    return name.startswith(OF_EVERY_SOURCE) or (
        name.endswith((".cpp", ".hpp", ".h", "CMakeLists.txt")) and ROOT.joinpath(name).parent in folders)


def keep(part):
    if git("status", "--porcelain") != []:
        sys.exit("not everything is committed: no commit was found clean")
    commits = clean_commits() | {part: git("rev-parse", "HEAD")[0]}
    CLEAN.write_text("".join(f"{name} {commit}\n" for name, commit in sorted(commits.items())))


def main():
    if sys.argv[1:2] == ["keep"] and sys.argv[2:] in (["tidy"], ["threads"]):
        return keep(sys.argv[2])
    if sys.argv[1:] not in (["tidy"], ["threads"]):
        sys.exit(__doc__)
    changed = changed_files(sys.argv[1])
    if changed is None:
        sys.exit(3)
    if sys.argv[1] == "threads":
        folders = where_threads_are()
        changed = {name for name in changed if is_for_threads(name, folders)}
    print("\n".join(sorted(changed)), end="\n" if changed else "")


if __name__ == "__main__":
    main()
