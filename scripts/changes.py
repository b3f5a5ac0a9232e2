#!/usr/bin/env python3
"""What has changed since the last commit at which everything was found clean (scripts/clean_commit).

usage: changes.py                names the files, one a line; exit code 3: that commit is not known here
       changes.py threads        of these, the ones that lie where threads are; exit code 3 as above
       changes.py keep           says that this commit is clean; refused where something is not committed

`./check --full` looks at everything and keeps the commit. `./check` looks at what has changed since.
"""
import re
import subprocess
import sys
from pathlib import Path

ROOT = Path(__file__).resolve().parents[1]
CLEAN = ROOT / "scripts/clean_commit"
THREADS = re.compile(r'#include (<(thread|mutex|atomic|condition_variable|shared_mutex|future)>|"realtime/spsc_queue\.hpp")')
# A change of these changes what every source is compiled to.
OF_EVERY_SOURCE = ("CMakeLists.txt", "CMakePresets.json", "cmake/", "protocol/")


def git(*arguments):
    done = subprocess.run(["git", *arguments], cwd=ROOT, text=True, capture_output=True, check=False)
    return done.stdout.splitlines() if done.returncode == 0 else None


def changed_files():
    """Paths from the root, what is not committed counted in. None where the clean commit is not known."""
    try:
        commit = CLEAN.read_text().strip()
    except OSError:
        return None
    changed, new = git("diff", "--name-only", "--no-renames", commit), git("ls-files", "-o", "--exclude-standard")
    return None if changed is None or new is None else set(changed) | set(new)


def where_threads_are():
    """Folders with a source or header that starts, locks or shares something."""
    return {path.parent for folder in ("src", "drivers", "clients/python/module", "tests")
            for path in (ROOT / folder).rglob("*.[ch]pp") if THREADS.search(path.read_text())}


def is_for_threads(name, folders):
    return name.startswith(OF_EVERY_SOURCE) or (
        name.endswith((".cpp", ".hpp", ".h", "CMakeLists.txt")) and ROOT.joinpath(name).parent in folders)


def keep():
    if git("status", "--porcelain") != []:
        sys.exit("not everything is committed: no commit was found clean")
    CLEAN.write_text(git("rev-parse", "HEAD")[0] + "\n")


def main():
    if sys.argv[1:] == ["keep"]:
        return keep()
    if sys.argv[1:] not in ([], ["threads"]):
        sys.exit(__doc__)
    changed = changed_files()
    if changed is None:
        sys.exit(3)
    if sys.argv[1:]:
        folders = where_threads_are()
        changed = {name for name in changed if is_for_threads(name, folders)}
    print("\n".join(sorted(changed)), end="\n" if changed else "")


if __name__ == "__main__":
    main()
