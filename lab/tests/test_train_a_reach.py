"""train_a_reach.py: evolution trains a policy to reach a target."""
import os
import re
import subprocess
import sys
import unittest

import numpy
from app import BINARY, HANG_S, SOURCE, main


class Training(unittest.TestCase):
    def test_a_short_training_raises_the_reward_slow(self):
        done = subprocess.run([sys.executable, "-B", SOURCE / "lab/train_a_reach.py", "--generations", "6",
                               "--seconds", "300"], capture_output=True, text=True, timeout=HANG_S,
                              env={**os.environ, "PYTHONPATH": str(BINARY.parent / "python")})
        self.assertEqual(done.returncode, 0, done.stderr)
        curve = [float(reward) for reward in re.findall(r" s   reward +(-[\d.]+)", done.stdout)]
        self.assertEqual(len(curve), 6, done.stdout)
        self.assertGreater(numpy.mean(curve[-2:]), 0.5 * numpy.mean(curve[:2]), done.stdout)  # rewards are negative
        learned, still = map(float, re.search(r"ends at ([\d.]+) mm; without a policy at ([\d.]+)", done.stdout).groups())
        self.assertLess(learned, 0.5 * still, done.stdout)


if __name__ == "__main__":
    main()
