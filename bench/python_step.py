#!/usr/bin/env python3
"""What a step from Python costs over the same loop in C++: CPU time of one run, the two in turn.

    ninja -C build/release wholehand_python rig_steps && /usr/bin/python3 bench/python_step.py

A step is one call of Rig.step(aim, n): n ticks of the six-axis device in the scene four-shapes, with an aim that moves
to and fro.
"""
import argparse
import pathlib
import statistics
import subprocess
import sys
import tempfile
import time

SOURCE = pathlib.Path(__file__).resolve().parents[1]


def aims_for(rows, ticks, start, numpy):
    """A slow circle about the start [m], with the fingers opening and closing [rad]."""
    time_s = 1e-3 * ticks * numpy.arange(rows)
    aims = numpy.tile(start, (rows, 1))
    aims[:, 0] += 0.02 * numpy.sin(2.0 * time_s)
    aims[:, 1] += 0.03 * (1.0 - numpy.cos(2.0 * time_s))
    aims[:, 3] += 0.3 * numpy.sin(3.0 * time_s)
    return aims


def python_s(rig, aims, ticks):
    rig.reset()
    began = time.process_time()
    for aim in aims:
        rig.step(aim, ticks)
    return time.process_time() - began


def cpp_s(program, aims_file, ticks, folder):
    done = subprocess.run([program, "loop", SOURCE / "config", str(ticks), aims_file, folder / "out"], check=True,
                          capture_output=True, text=True)
    return float(done.stdout)


def measure(build, ticks, rounds, total_ticks=10_000):
    """CPU seconds per tick of (C++, Python), one pair per round; the rig in Python runs the same ticks."""
    import numpy
    from wholehand.rig import Rig
    rig = Rig()
    aims = aims_for(total_ticks // ticks, ticks, rig.q_s.copy(), numpy)
    with tempfile.TemporaryDirectory() as name:
        folder = pathlib.Path(name)
        aims.tofile(folder / "aims")
        pairs = []
        for _ in range(rounds):
            cpp = cpp_s(build / "rig_steps", folder / "aims", ticks, folder)
            pairs.append((cpp / total_ticks, python_s(rig, aims, ticks) / total_ticks))
            last = numpy.fromfile(folder / "out")
            if last.tobytes() != numpy.concatenate([rig.q_m, rig.q_s, rig.sent]).tobytes():
                raise AssertionError("Python and C++ do not compute the same; their times say nothing")
    return pairs


def over(pairs):
    """Extra time of Python as a share of C++, from the least time of each, which other load affects least."""
    return min(python for _, python in pairs) / min(cpp for cpp, _ in pairs) - 1.0


def options_of(doc):
    """Parse --build and --rounds, and make the Python package of that build importable."""
    parser = argparse.ArgumentParser(description=doc.splitlines()[0])
    parser.add_argument("--build", type=pathlib.Path, default=SOURCE / "build/release")
    parser.add_argument("--rounds", type=int, default=9)
    options = parser.parse_args()
    sys.path.insert(0, str(options.build / "python"))
    return options


def main():
    options = options_of(__doc__)
    print(f"{'ticks a step':>12} {'C++ [µs/tick]':>14} {'Python [µs/tick]':>17} {'least over least':>17} {'median of pairs':>16}")
    for ticks in (1, 10, 100):
        pairs = measure(options.build, ticks, options.rounds)
        median = statistics.median(python / cpp for cpp, python in pairs) - 1.0
        print(f"{ticks:12d} {1e6 * min(c for c, _ in pairs):14.2f} {1e6 * min(p for _, p in pairs):17.2f} "
              f"{100 * over(pairs):+16.1f}% {100 * median:+15.1f}%")


if __name__ == "__main__":
    main()
