#!/usr/bin/env python3
"""Ticks a second of rigs in Python, and of MuJoCo alone with the same hand in the same motion.

    ninja -C build/release wholehand_python && /usr/bin/python3 bench/steps_per_second.py

The six-axis device plays reach-grasp-00 in the scene four-shapes: half a second without contact, and the half second
with most contact. A rig is device, patient, coupling, safety and physics; a step is a call of 10 ticks. If the lab is
built (docs/engines.md), `mujoco_steps` is timed too: mj_step() alone, whose hand follows the recorded motion of the
rig's hand. The times are wall times of the fastest round and include other load on the machine.
"""
import subprocess
import tempfile
import time

from python_step import SOURCE, options_of

TICKS, TICKS_A_STEP, RIGS, REACH_TICKS = 500, 10, 8, 7500


def touching(rig):
    """For each tick of the reach: True if the hand touches anything."""
    rig.reset()
    return [bool(rig.contact_count) for _ in range(REACH_TICKS) if rig.step()]


def windows(contacts):
    """First tick of each of the two half seconds."""
    sums = [sum(contacts[first:first + TICKS]) for first in range(0, REACH_TICKS - TICKS, 50)]
    return {"nothing touched": 50 * sums.index(0), "something gripped": 50 * sums.index(max(sums))}


def motion(rig, first, numpy):
    """The numbers that mujoco_steps reads: poses of the bodies, then q_s and its speeds before each tick."""
    rig.reset()
    rig.step(n=max(1, first))
    parts = [numpy.concatenate([rig.bodies["position_m"], rig.bodies["orientation_xyzw"]], axis=1).ravel()]
    for _ in range(TICKS):
        rig.step()
        parts += [rig.q_s.copy(), rig.qd_s.copy()]
    return numpy.concatenate(parts)


def rigs_hz(rigs, first, rounds):
    """Ticks per second of all rigs together."""
    best_s = float("inf")
    for _ in range(rounds):
        rigs.reset([0] * len(rigs))
        rigs.step(n=max(1, first))
        began = time.perf_counter()
        for _ in range(TICKS // TICKS_A_STEP):
            rigs.step(n=TICKS_A_STEP)
        best_s = min(best_s, time.perf_counter() - began)
    return len(rigs) * TICKS / best_s


def rounded(hz):
    """The number rounded to three digits."""
    return f"{float(f'{hz:.3g}'):,.0f}"


def main():
    options = options_of(__doc__)
    import numpy
    from wholehand.rig import Rig, VectorRig
    rig = Rig()
    contacts = touching(rig)
    for what, first in windows(contacts).items():
        share = sum(contacts[first:first + TICKS]) / TICKS
        print(f"figure: {what}: ticks with contact = {100 * share:.0f} %")
        for threads in (1, 2):
            hz = rigs_hz(VectorRig(RIGS, threads=threads), first, options.rounds)
            print(f"figure: {what}: rigs in Python, {threads} thread{'s' * (threads > 1)} = {rounded(hz)} ticks/s")
        program = options.build / "mujoco_steps"
        if not program.exists():
            print(f"{what}: MuJoCo alone is not measured: {program} is a part of the lab (./start --lab)")
            continue
        with tempfile.NamedTemporaryFile() as file:
            motion(rig, first, numpy).tofile(file.name)
            for threads in (1, 2):
                said = subprocess.run([program, SOURCE / "config", file.name, str(threads), str(options.rounds)], check=True,
                                      capture_output=True, text=True).stdout.split()
                print(f"figure: {what}: MuJoCo alone, {threads} thread{'s' * (threads > 1)} = {rounded(float(said[0]))} ticks/s")
            print(f"figure: {what}: MuJoCo's ticks with contact = {100 * float(said[1]):.0f} %")


if __name__ == "__main__":
    main()
