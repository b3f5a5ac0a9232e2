"""A program that is stopped during a contact, and one whose processors are used by others: no effort jumps, a simulated
device does not stop for it, and a stop is obeyed."""
import os
import re
import select
import signal
import subprocess
import sys
import time

import numpy

import faulty_disk  # noqa: F401  makes the following modules importable
from app import ALWAYS, HANG_S, INTERRUPTED, PacedTest, main, read_recording

SLEW_PER_MS = 0.25  # share of the effort limit: docs/safety.md, kEffortSlew
ROUNDING = 1e-9
STALLS_IN_CONTACT = 3


class Standstill(PacedTest):
    def start_bar(self):
        run = self.start_app("run", "--no-web", "--no-rehearsal", "--duration", 600, "--record", "run.h5")
        self.wait_until_it_renders(run)
        return run

    def expect_no_jump(self):
        """Checks the sent efforts from each tick to the next one that ran; returns the contacts at each."""
        with read_recording(self.folder / "run.h5") as recording:
            sent = numpy.asarray(recording["ticks/sent"])
            limits = numpy.asarray(recording["meta"].attrs["effort_limits"])
            contacts = numpy.asarray(recording["ticks/contact_count"])
            ticks = numpy.asarray(recording["ticks/tick"]).astype(numpy.int64)
        share = numpy.abs(numpy.diff(sent, axis=0)) / limits
        self.assertLessEqual(share.max(), SLEW_PER_MS * (1 + ROUNDING), ALWAYS)
        return contacts, numpy.diff(ticks)

    def test_no_effort_jumps_when_stopped_and_continued_in_contact(self):
        run = self.start_bar()
        out, more, until = "", STALLS_IN_CONTACT, time.monotonic() + HANG_S
        while more > 0 and time.monotonic() < until:
            time.sleep(self.random.uniform(0.25, 0.5))
            run.send_signal(signal.SIGSTOP)
            time.sleep(self.random.uniform(0.02, 0.3))
            run.send_signal(signal.SIGCONT)
            while run.poll() is None and select.select([run.stdout], [], [], 0)[0]:
                out += os.read(run.stdout.fileno(), 4096).decode()
            if re.search(r"  [1-9]\d* contacts?  largest", out):  # a status line is printed every 5 s
                more -= 1
        run.send_signal(signal.SIGTERM)
        rest, err = run.communicate(timeout=HANG_S)
        self.assertEqual(run.returncode, INTERRUPTED, out + rest + err)
        self.assertIn("faults   none", rest)
        contacts, gaps = self.expect_no_jump()
        stalled = gaps > 20
        self.assertGreater(stalled.sum(), 5)
        self.assertGreater((stalled & (contacts[:-1] > 0)).sum(), 0, "no stall met a contact")

    def test_busy_processors_do_not_end_the_run_and_a_stop_is_obeyed(self):
        busy = [subprocess.Popen([sys.executable, "-c", "while True: pass"]) for _ in range(2 * os.cpu_count())]
        for program in busy:
            self.addCleanup(program.wait)
            self.addCleanup(program.kill)
        run = self.start_bar()
        time.sleep(4.0)
        run.send_signal(signal.SIGTERM)
        out, err = run.communicate(timeout=HANG_S)
        self.assertEqual(run.returncode, INTERRUPTED, out + err)
        self.assertIn("faults   none", out)
        self.expect_no_jump()


if __name__ == "__main__":
    main()
