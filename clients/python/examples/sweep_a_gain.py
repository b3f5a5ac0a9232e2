"""Compares stiffnesses of the arm's coupling by the same recorded reach.

    python3 sweep_a_gain.py                    # `wholehand` in PATH; --program PATH otherwise

For each stiffness that `wholehand certify` passes: the lag of the simulated hand behind the real one without contact
(a large lag feels heavy), and the largest force in contact.
"""
import argparse
import pathlib
import re
import subprocess
import sys
import tempfile

import numpy

import wholehand

AXES = ("x", "y", "z")


def run(program, gains, folder, seconds):
    """A recording, or the reason why these gains are refused."""
    done = subprocess.run([program, "run", "--rendering", gains, "--simulated-clock", "--no-web", "--duration", str(seconds),
                           "--motion", "data/human-motion/reach-grasp-00.csv", "--record", folder / "run.h5"],
                          capture_output=True, text=True)
    if done.returncode == 0:
        return folder / "run.h5", ""
    return None, (done.stderr.strip().splitlines() or ["no reason was given"])[0]


def sweep(program, stiffnesses_n_m, gains_file, seconds):
    text = pathlib.Path(gains_file).read_text()
    print(f"{'K_pm of the arm':>16} {'lag, free':>12} {'felt at most':>14}")
    for stiffness_n_m in stiffnesses_n_m:
        with tempfile.TemporaryDirectory() as name:
            folder = pathlib.Path(name)
            gains = folder / pathlib.Path(gains_file).name
            gains.write_text(re.sub(r"(?m)^k_pm_n_m = .*$", f"k_pm_n_m = {stiffness_n_m}", text))
            recording, refused = run(program, gains, folder, seconds)
            if recording is None:
                print(f"{stiffness_n_m:12.0f} N/m   refused: {refused}")
                continue
            with wholehand.open(recording) as f:
                data = f.to_xarray("q_m", "q_s", "coupling", "contact_count")
            arm = data.sel(axis=list(AXES))
            free = data["contact_count"] == 0
            lag_mm = 1e3 * float(abs(arm["q_m"] - arm["q_s"]).where(free).max())
            felt = arm["coupling"].where(~free)
            felt_n = "nothing" if bool(free.all()) else f"{float(numpy.sqrt((felt ** 2).sum('axis')).max()):.2f} N"
            print(f"{stiffness_n_m:12.0f} N/m {lag_mm:9.2f} mm {felt_n:>14}")


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--program", default="wholehand")
    parser.add_argument("--gains", default="config/rendering/lambda-pride.toml")
    parser.add_argument("--stiffness", type=float, nargs="+", default=[250.0, 500.0, 1000.0, 4000.0], help="N/m")
    parser.add_argument("--seconds", type=float, default=5.0)
    options = parser.parse_args()
    try:
        sweep(options.program, options.stiffness, options.gains, options.seconds)
    except FileNotFoundError as error:
        sys.exit(f"{error.filename}: not found; run this in the project's folder, or name --program and --gains")


if __name__ == "__main__":
    main()
