#!/usr/bin/env python3
"""Counts what the hardening of release builds costs a tick: instructions with and without it.

usage: hardening_cost.py show [SCENE ...]   builds both, counts, and prints each scene's ratio
       hardening_cost.py write              the same of every scene, kept and written to docs/performance.md

Needs Debian's valgrind, and build/release configured with the benchmarks (bench/CMakeLists.txt). The build
without hardening is made below build/unhardened: measure_tick and what it links, some minutes the first time.
"""
import json
import subprocess
import sys

from tick_cost import DATA, PROGRAM, ROOT, SCENES, count, load, page, total

WITHOUT = ROOT / "build/unhardened"
KEPT = ["CMAKE_BUILD_TYPE", "CMAKE_CXX_COMPILER", "CMAKE_CXX_FLAGS_RELEASE", "WHOLEHAND_LAB"]


def run(*command):
    done = subprocess.run([str(word) for word in command], cwd=ROOT, text=True, capture_output=True, check=False)
    if done.returncode != 0:
        sys.exit(f"{' '.join(map(str, command))}: exit code {done.returncode}\n{(done.stdout + done.stderr)[-2000:]}")


def build():
    release = PROGRAM.parent
    cache = release / "CMakeCache.txt"
    if not cache.exists():
        sys.exit(f"{release} is not configured: cmake --preset release -DWHOLEHAND_BUILD_BENCH=ON")
    lines = cache.read_text(encoding="utf-8").splitlines()
    same = ["-D" + line for line in lines if line.split(":")[0] in KEPT]
    run("cmake", "-S", ROOT, "-B", WITHOUT, "-G", "Ninja", *same, "-DWHOLEHAND_HARDENED=OFF",
        "-DWHOLEHAND_BUILD_BENCH=ON", "-DWHOLEHAND_BUILD_TESTS=OFF")
    for folder in (WITHOUT, release):
        run("cmake", "--build", folder, "--target", PROGRAM.name)


def compare(scenes):
    """{scene: (instructions of a tick without, with hardening)}"""
    found = {}
    for scene in scenes:
        without, hardened = (total(count(scene, folder / PROGRAM.name)) for folder in (WITHOUT, PROGRAM.parent))
        found[scene] = [without, hardened]
        print(f"{scene}: {without:,} instructions a tick, hardened {hardened:,}: {100 * (hardened / without - 1):+.2f} %",
              flush=True)
    return found


def main():
    command, scenes = (sys.argv[1] if len(sys.argv) > 1 else ""), sys.argv[2:]
    unknown = [scene for scene in scenes if scene not in SCENES]
    if command not in ("show", "write") or unknown or (command == "write" and scenes):
        sys.exit(__doc__ + "\nScenes: " + ", ".join(SCENES))
    build()
    found = compare(scenes or SCENES)
    if command == "write":
        data = load()
        data["hardening"] = found
        DATA.write_text(json.dumps(data, indent=1) + "\n", encoding="utf-8")
        page(data)


if __name__ == "__main__":
    main()
