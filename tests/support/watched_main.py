"""main() of the tests in Python. A test whose class says `paced = True` sees real time: additional processes only sleep
while it runs, one per processor. If it fails while one of them was kept waiting, it is reported as not judged and
fails nothing; no test is repeated. `terminal = True` is for a test over a terminal: a kernel thread carries its bytes
and may wait although every sleeper wakes in time, so one sleeper passes a byte over a terminal each time. Errors,
crashes, hangs and failures that contain ALWAYS are never excused. The same as watched_main.cpp.

A test whose name ends in _slow runs only with WHOLEHAND_FULL=1 or by its name."""
import os
import pathlib
import subprocess
import sys
import traceback
import unittest

FULL = os.environ.get("WHOLEHAND_FULL") == "1"
ALWAYS = "(whatever the machine does) "
KEPT_WAITING_S = 0.005  # see watched_main.hpp for the reason
HANG_S = 300.0  # ends a hang, not a slow test

# Sleeps a millisecond at a time on one processor, since a process that may move would wake on an idle one. For every
# input line it reports by how much the longest sleep since the last report was exceeded. Without a processor argument
# it also passes a byte over a terminal.
SLEEPER = """
import os, pty, select, sys, time, tty
if sys.argv[1:]:
    os.sched_setaffinity(0, {int(sys.argv[1])})
else:
    here, there = pty.openpty()
    tty.setraw(there)
longest, last = 0.0, time.monotonic()
while True:
    asked = select.select([sys.stdin], [], [], 0.001)[0]
    if not sys.argv[1:]:
        os.write(here, b".")
        os.read(there, 1)
    now = time.monotonic()
    longest, last = max(longest, now - last - 0.001), now
    if asked:
        if not sys.stdin.readline():
            break
        print(longest, flush=True)
        longest = 0.0
"""


class Sleepers:
    """Measures how long this machine kept sleeping processes waiting."""

    def __init__(self, terminal):
        where = [[str(processor)] for processor in sorted(os.sched_getaffinity(0))] + ([[]] if terminal else [])
        self.processes = [subprocess.Popen([sys.executable, "-ISc", SLEEPER, *one], text=True, stdin=subprocess.PIPE,
                                           stdout=subprocess.PIPE) for one in where]
        self.longest = 0.0
        self.longest_s()
        self.longest = 0.0  # from here on

    def longest_s(self):
        for process in self.processes:
            process.stdin.write("\n")
            process.stdin.flush()
            self.longest = max(self.longest, float(process.stdout.readline()))
        return self.longest

    def end(self):
        for process in self.processes:
            process.communicate()


class Judge(unittest.TextTestResult):
    judged, not_judged, sleepers = 0, 0, None

    def startTest(self, test):
        super().startTest(test)
        if getattr(test, "paced", False):
            self.sleepers, self.excused = Sleepers(getattr(test, "terminal", False)), False

    def stopTest(self, test):
        super().stopTest(test)
        if self.sleepers:
            self.sleepers.end()
            self.sleepers = None
            self.judged, self.not_judged = self.judged + (not self.excused), self.not_judged + self.excused

    def excuses(self, test, error):
        """True if the machine excuses the failure; then prints the reason."""
        kind, failure, trace = error
        if not self.sleepers or not issubclass(kind, test.failureException) or ALWAYS in str(failure):
            return False
        waited_s = self.sleepers.longest_s()
        if waited_s <= KEPT_WAITING_S:
            return False
        place = next(frame for frame in reversed(traceback.extract_tb(trace)) if "unittest" not in frame.filename)
        reason = (str(failure).splitlines() or [""])[0]
        name = ".".join(test.id().split(".")[-2:])
        print(f"not judged: {name}: this machine kept a sleeper waiting for {1e3 * waited_s:.0f} ms "
              f"({pathlib.Path(place.filename).name}:{place.lineno}: {reason})", flush=True)
        self.excused = True
        return True

    def addFailure(self, test, err):
        if not self.excuses(test, err):
            super().addFailure(test, err)

    def addSubTest(self, test, subtest, err):
        if err is None or not self.excuses(test, err):
            super().addSubTest(test, subtest, err)


class Names(unittest.TestLoader):
    def getTestCaseNames(self, of):
        return [name for name in super().getTestCaseNames(of) if FULL or not name.endswith("_slow")]


def main(arguments=None):
    """@param arguments of unittest; None: the program's own"""
    program = unittest.main("__main__", argv=[sys.argv[0], *(sys.argv[1:] if arguments is None else arguments)],
                            testLoader=Names(), exit=False,
                            testRunner=unittest.TextTestRunner(resultclass=Judge, verbosity=2))
    result = program.result
    if result.judged + result.not_judged > 0:
        print(f"real time: {result.judged} judged, {result.not_judged} not judged", flush=True)
    sys.exit(not result.wasSuccessful())
