#!/usr/bin/env python3
"""Counts the instructions of a tick, stage by stage, and compares them with a baseline.

usage: tick_cost.py show [SCENE ...]   counts, and prints each scene's ratio to the baseline and its spread
       tick_cost.py check [SCENE ...]  counts, and fails where a tick takes more instructions than were kept
       tick_cost.py compare            counts scenes that differ by one thing, and orders to bodies, and fails where
                                       that costs more than is allowed
       tick_cost.py write              counts every scene, keeps the counts and writes docs/performance.md
       tick_cost.py baseline           the same, and makes these counts the baseline
       tick_cost.py spread             the spread of single ticks only; does not keep it

Needs Debian's valgrind and build/release/measure_tick (bench/CMakeLists.txt says how to build it).
Instructions are counted, not time: they are the same on a busy machine.
"""
import json
import re
import subprocess
import sys
import tempfile
from collections import Counter
from math import ceil
from pathlib import Path

ROOT = Path(__file__).resolve().parents[1]
PROGRAM = ROOT / "build/release/measure_tick"
DATA, PAGE = ROOT / "bench/tick_cost.json", ROOT / "docs/performance.md"
TICKS = 1000
SCENES = {
    "near": "hand at rest among four bodies, nothing touched",
    "approach": "the bar, first second: the hand comes",
    "squeeze": "the bar, a dispenser squeezed through its walls",
    "hold-cube": "a cube grasped, lifted and held",
    "hold-cylinder": "a cylinder grasped, lifted and held",
    "drawer": "a drawer's bar grasped and pulled",
    "pile-100": "100 balls in a pile, the hand presses on them and sways",
}
# Scenes that ./check counts: no contact, and a grip through the bar's walls. ALLOWED: difference of the counts between
# two processors and versions of libraries.
CHECKED, ALLOWED = ("near", "squeeze"), 1.03
# Scenes and numbers of ticks whose spread is shown; also the bar from its start through the approach and the first
# squeeze.
FROM_START = "approach to squeeze"
SPREADS = {**{scene: (scene, TICKS) for scene in SCENES if scene != "approach"}, FROM_START: ("approach", 5000)}
# Allowed cost of one additional thing in a scene: scene, other scene without it, stage (None: the whole tick), factor
# on the other's instructions, additional instructions.
COMPARED = [
    ("far-1000", "far-0", None, 1.85, 0, "a thousand bodies out of reach"),
    ("slots", "no-slots", None, 1.0, 9000, "64 parked slots"),
    ("close-50", "close-50-bare", "physics step", 1.10, 0, "self-contacts and armature in free motion"),
    ("close-100", "close-100-bare", "physics step", 2.1, 0, "the same, into a pinch and out of it"),
    ("guided", "unguided", None, 1.02, 0, "a prescription: limits on every axis, and a corridor"),
    ("squeeze", "squeeze-bare", None, 1.10, 0, "self-contacts, armature and energy tank"),
    ("drawer-tree", "drawer", None, 1.5, 0, "two flaps on the drawer under the hand"),
]
ORDERS, ORDER_P50, ORDER_WORST = 600, 45_000, 1.5  # the last is the allowed ratio of p99.9 to p50
# Functions that the tick calls, and the stage of each. The first match counts.
STAGES = [
    ("device", r"readDevice|writeDevice|Device::(read|write)|checkReading|checkWrite"),
    ("observe", r"observeWorld|::observe\(|checkWorld"),
    ("dynamics", r"updateDynamics|ArticulatedBody::update"),
    ("palm, closure", r"probeHand|HandProbe::|PalmDistance|AxisClosure"),
    ("control", r"couple\(|estimateVelocity|avatar(Damping|Effort)|couplingEffort|damp\(|adaptDamping"),
    ("exercise", r"HapticRenderer::exercise|Exercise|::tick\("),
    ("safety", r"SafetyChain|watchEnergy|limitEffort"),
    ("physics step", r"stepWorld|::step\(|distribute|armatureEffort"),
    ("contacts", r"readContacts|::contacts\("),
]
REST = "the tick itself"


def stage_of(function):
    return next((stage for stage, pattern in STAGES if re.search(pattern, function)), REST)


def read_profile(path, cost):
    """Adds the instructions of HapticRenderer::tick and the functions that it calls, by stage; returns their sum."""
    names = {}
    function = callee = None
    called = False
    before = total(cost)

    def name(text):
        number, _, full = text.partition(" ")
        return names.setdefault(number, full)

    for line in path.read_text(encoding="utf-8").splitlines():
        if line.startswith("fn="):
            function = name(line[3:])
        elif line.startswith("cfn="):
            callee = name(line[4:])
        elif line.startswith("calls="):
            called = True
        elif re.match(r"[\d+*-]", line):
            words = line.split()
            if function and function.startswith("wholehand::HapticRenderer::tick("):
                cost[stage_of(callee) if called else REST] += int(words[1]) if len(words) > 1 else 0
            called = False
    return total(cost) - before


def profile(scene, ticks, program, *options):
    """Runs Callgrind; yields the files that it writes to a temporary folder."""
    with tempfile.TemporaryDirectory(prefix="wholehand-tick-cost-") as folder:
        command = ["valgrind", "--tool=callgrind", "--toggle-collect=wholehand::measured*", "--dump-line=no",
                   *options, f"--callgrind-out-file={folder}/profile", str(program), scene, str(ticks)]
        try:
            done = subprocess.run(command, cwd=ROOT, text=True, capture_output=True, check=False)
        except FileNotFoundError:
            sys.exit("valgrind is not installed: apt install valgrind")
        if done.returncode != 0:
            sys.exit(f"{' '.join(command)}: exit code {done.returncode}\n{done.stderr[-2000:]}\n"
                     "if the program is missing: cmake --preset release -DWHOLEHAND_BUILD_BENCH=ON && "
                     "ninja -C build/release measure_tick")
        yield from Path(folder).iterdir()


def count(scene, program=PROGRAM):
    """{stage: mean instructions of a tick}"""
    cost = Counter()
    for path in profile(scene, TICKS, program):
        read_profile(path, cost)
    if not cost:
        sys.exit(f"{scene}: the profile names no HapticRenderer::tick; build with symbols")
    return {stage: round(cost[stage] / TICKS) for stage in [*(s for s, _ in STAGES), REST]}


def spread(name):
    """Instructions of single ticks: median and 99.9th percentile."""
    scene, ticks = SPREADS[name]
    return quantiles(scene, ticks, lambda path: read_profile(path, Counter()))


def quantiles(scene, ticks, read):
    """Instructions of single ticks or orders: median and 99.9th percentile.

    @param read returns the instructions of a profile, given its path
    """
    each = sorted(read(path) for path in profile(scene, ticks, PROGRAM, "--dump-before=wholehand::countedOne*"))
    each = each[-ticks:]  # without the empty profile of the program's end
    if len(each) < ticks or each[0] == 0:
        sys.exit(f"{scene}: {len(each)} profiles of {ticks}")
    return {"ticks": ticks, "p50": each[ceil(0.5 * ticks) - 1], "p99.9": each[ceil(0.999 * ticks) - 1]}


def spread_text(found):
    return f"p50 {found['p50']:,}, p99.9 {found['p99.9']:,}, {found['p99.9'] / found['p50']:.2f} x"


def total(counts):
    return sum(counts.values())


def load():
    return json.loads(DATA.read_text(encoding="utf-8")) if DATA.exists() else {"baseline": {}, "counts": {}}


def show(scenes):
    baseline = load()["baseline"]
    for scene in scenes:
        now, before = count(scene), baseline.get(scene)
        against = f", {total(now) / total(before):.2f} x the baseline" if before else ", no baseline"
        print(f"{scene}: {total(now):,} instructions a tick{against}")
        for stage, instructions in now.items():
            was = f" (baseline {before[stage]:,})" if before else ""
            print(f"  {stage:16} {instructions:9,}{was}", flush=True)
        if scene in SPREADS:
            print(f"  single ticks: {spread_text(spread(scene))}", flush=True)


def check(scenes):
    """Ends with exit code 1 when a tick needs more instructions than allowed."""
    kept, dearer = load()["counts"], []
    for scene in scenes:
        now, before = count(scene), kept[scene]
        ratio = total(now) / total(before)
        print(f"figure: {scene}: {total(now):,} instructions a tick, {ratio:.3f} x those kept", flush=True)
        if ratio > ALLOWED:
            stages = sorted(now, key=lambda stage: before[stage] - now[stage])[:3]
            dearer.append(f"{scene}: {ratio:.3f} x; most in " + ", ".join(f"{s} ({now[s] - before[s]:+,})" for s in stages))
    if dearer:
        sys.exit("a tick takes more instructions than were kept (if it must: scripts/tick_cost.py write):\n" + "\n".join(dearer))


def compare():
    """Ends with exit code 1 when an additional thing costs more than allowed."""
    dearer = []

    def judge(what, instructions, most):
        print(f"figure: {what} = {instructions:,} instructions", flush=True)
        if instructions > most:
            dearer.append(f"{what}: {instructions:,} instructions, at most {most:,.0f}")
    for scene, other, stage, times, more, what in COMPARED:
        now, without = (count(name) for name in (scene, other))
        now, without = (counts[stage] if stage else total(counts) for counts in (now, without))
        print(f"figure: {what}, over without = {now / without:.3f} ")
        judge(f"{what}, {stage or 'tick'}", now, times * without + more)
    orders = quantiles("orders", ORDERS, total_of_profile)
    judge("an order to a body, p50", orders["p50"], ORDER_P50)
    judge("an order to a body, p99.9", orders["p99.9"], ORDER_WORST * orders["p50"])
    if dearer:
        sys.exit("more instructions than are allowed:\n" + "\n".join(dearer))


def total_of_profile(path):
    """Number of instructions that Callgrind counted in a profile."""
    found = re.search(r"^totals: (\d+)", path.read_text(encoding="utf-8"), re.MULTILINE)
    return int(found[1]) if found else 0


def hardening_lines(hardening):
    """Section of the page with the counts of scripts/hardening_cost.py."""
    if not hardening:
        return []
    lines = ["## What hardening costs", "",
             "Counted by `scripts/hardening_cost.py write`: the same build with and without the guarded stack, the "
             "fortified library calls and the read-only tables of a release build.", "",
             "| scene | without | hardened | more |", "|---|---:|---:|---:|"]
    for scene, (without, hardened) in hardening.items():
        lines.append(f"| `{scene}` | {without:,} | {hardened:,} | {100 * (hardened / without - 1):.2f} % |")
    return lines


def spread_lines(spreads):
    """Section of the page about single ticks."""
    if not spreads:
        return []
    lines = ["## Spread of single ticks", "",
             "Instructions of each tick by itself. The last line is the bar from its start: the hand comes, grips and "
             "squeezes.", "",
             "| scene | ticks | p50 | p99.9 | p99.9 over p50 |", "|---|---:|---:|---:|---:|"]
    for name, found in spreads.items():
        shown = name if name == FROM_START else f"`{name}`"
        lines.append(f"| {shown} | {found['ticks']:,} | {found['p50']:,} | {found['p99.9']:,} | "
                     f"{found['p99.9'] / found['p50']:.2f} |")
    return lines


def page(data):
    lines = ["# What a tick costs", "",
             "Written by `scripts/tick_cost.py write`; do not edit. Instructions of one tick, mean over "
             f"{TICKS:,} ticks, counted by Callgrind on the build `release`. Times depend on the machine: "
             "`build/release/measure_tick SCENE` and `wholehand experiment timing` print them. The baseline is the code "
             "before [ADR 37](adr/0037-collision-pairs-without-bullet.md); of `pile-100`, that before "
             "`BodyRows` of [ADR 42](adr/0042-resting-bodies-and-vector-rows.md).", "",
             "| scene | baseline | now | ratio |", "|---|---:|---:|---:|"]
    for scene, text in SCENES.items():
        before, now = total(data["baseline"].get(scene, {})), total(data["counts"][scene])
        against = f"{before:,} | {now:,} | {now / before:.2f}" if before else f"| {now:,} |"
        lines.append(f"| `{scene}`: {text} | {against} |")
    lines += ["", "## By stage, now", "",
              "| stage | " + " | ".join(f"`{s}`" for s in SCENES) + " |", "|---|" + "---:|" * len(SCENES)]
    for stage in [*(s for s, _ in STAGES), REST]:
        if any(data["counts"][s][stage] for s in SCENES):
            lines.append(f"| {stage} | " + " | ".join(f"{data['counts'][s][stage]:,}" for s in SCENES) + " |")
    lines += ["", *spread_lines(data.get("spread", {}))]
    lines += ["", *hardening_lines(data.get("hardening", {}))]
    PAGE.write_text("\n".join(lines).rstrip() + "\n", encoding="utf-8")


def write(as_baseline):
    data = load()
    data["counts"] = {scene: count(scene) for scene in SCENES}
    data["spread"] = {name: spread(name) for name in SPREADS}
    if as_baseline:
        data["baseline"] = data["counts"]
    DATA.write_text(json.dumps(data, indent=1) + "\n", encoding="utf-8")
    page(data)


def main():
    command, scenes = (sys.argv[1] if len(sys.argv) > 1 else ""), sys.argv[2:]
    unknown = [scene for scene in scenes if scene not in SCENES]
    if command not in ("show", "check", "compare", "write", "baseline", "spread") or unknown:
        sys.exit(__doc__ + "\nScenes: " + ", ".join(SCENES))
    if command == "show":
        show(scenes or SCENES)
    elif command == "check":
        check(scenes or CHECKED)
    elif command == "compare":
        compare()
    elif command == "spread":
        for name in SPREADS:
            print(f"{name}: {spread_text(spread(name))}", flush=True)
    else:
        write(command == "baseline")


if __name__ == "__main__":
    main()
