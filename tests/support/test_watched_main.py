"""Judgements of watched_main.py on failures. The cases run only by name, in a separate process."""
import os
import pathlib
import signal
import subprocess
import sys
import time
import unittest

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parent))
import watched_main  # noqa: E402
from watched_main import ALWAYS, main  # noqa: E402


class Case(unittest.TestCase):
    paced = True

    def stall(self):
        """Stops only the last sleeper: a stall that leaves this process alone."""
        sleepers = subprocess.run(["pgrep", "-P", str(os.getpid()), "-f", "select"], capture_output=True, text=True).stdout
        sleeper = int(sleepers.split()[-1])
        os.kill(sleeper, signal.SIGSTOP)
        time.sleep(0.05)
        os.kill(sleeper, signal.SIGCONT)

    def test_fails_undisturbed_slow(self):
        watched_main.KEPT_WAITING_S = float("inf")
        self.fail("at once")

    def test_fails_after_a_stall_slow(self):
        self.stall()
        self.fail("late")

    def test_fails_in_a_part_after_a_stall_slow(self):
        with self.subTest("part"):
            self.stall()
            self.fail("late")

    def test_fails_whatever_the_machine_does_slow(self):
        self.stall()
        self.fail(ALWAYS + "late")

    def test_ends_in_an_error_after_a_stall_slow(self):
        self.stall()
        raise OSError("gone")


class TerminalCase(Case):
    terminal = True


class WatchedMain(unittest.TestCase):
    def test_failure_is_excused_by_a_stall_only(self):
        for case, code, says in (("Case.test_fails_undisturbed", 1, "real time: 1 judged, 0 not judged"),
                                 ("Case.test_fails_after_a_stall", 0, "real time: 0 judged, 1 not judged"),
                                 ("TerminalCase.test_fails_after_a_stall", 0, "real time: 0 judged, 1 not judged"),
                                 ("Case.test_fails_in_a_part_after_a_stall", 0, "real time: 0 judged, 1 not judged"),
                                 ("Case.test_fails_whatever_the_machine_does", 1, "real time: 1 judged, 0 not judged"),
                                 ("Case.test_ends_in_an_error_after_a_stall", 1, "real time: 1 judged, 0 not judged")):
            with self.subTest(case):
                done = subprocess.run([sys.executable, "-B", __file__, f"{case}_slow"], text=True, capture_output=True)
                self.assertEqual(done.returncode, code, done.stdout + done.stderr)
                self.assertIn(says, done.stdout)
                if code == 0:
                    self.assertRegex(done.stdout, rf"(?m)^not judged: {case}_slow: this machine kept a sleeper "
                                     r"waiting for \d+ ms \(test_watched_main.py:\d+: late\)$")

    def test_slow_tests_run_in_full_or_by_name(self):
        named = watched_main.Names().getTestCaseNames(Case)
        self.assertEqual(len(named), 5 if watched_main.FULL else 0)


if __name__ == "__main__":
    if watched_main.FULL and len(sys.argv) == 1:
        sys.argv.append("WatchedMain")  # its cases fail on purpose
    main()
