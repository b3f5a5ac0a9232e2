"""Prints the contacts and forces of a recorded hand as a table.

    wholehand run --motion data/human-motion/reach-grasp-00.csv --simulated-clock --record run.h5
    python3 look_at_a_recording.py run.h5
"""
import sys

import numpy

import wholehand


def look(path):
    with wholehand.open(path) as run:
        frame = run.to_pandas("q_m", "sent")
        units = frame.attrs["units"]
        touching = run["ticks/contact_count"][:] > 0
        periods_s = run["ticks/elapsed_periods"][:] * run.meta["period_s"]
        print(f"{run.meta['title'].decode()}: {len(frame)} ticks, {frame.index[-1]:.2f} s, "
              f"touching for {periods_s[touching].sum():.2f} s")
        print(f"{'axis':>20} {'travelled':>14} {'largest effort':>16} {'work on the person':>19}")
        for axis in frame["q_m"].columns:
            position, effort = frame["q_m"][axis].to_numpy(), frame["sent"][axis].to_numpy()
            step = numpy.diff(position)
            work_j = float(numpy.sum(effort[:-1] * step))  # an effort holds until the next tick
            print(f"{axis:>20} {abs(step).sum():10.3f} {units['q_m', axis]:<3} "
                  f"{abs(effort).max():12.3f} {units['sent', axis]:<3} {work_j:17.4f} J")
        print("Work is positive where the device gave, negative where the person did.")


if __name__ == "__main__":
    if len(sys.argv) != 2:
        sys.exit("usage: look_at_a_recording.py RECORDING.h5")
    look(sys.argv[1])
