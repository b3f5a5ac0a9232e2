"""`wholehand device commission` at a terminal: a held key, wrong answers, and every way to release the key."""
import fcntl
import mmap
import os
import pty
import re
import select
import signal
import struct
import subprocess
import sys
import termios
import time

from app import ALWAYS, BINARY, HANG_S, main
from device_app import DRIVERS, DeviceTest

HAND, STOP, ENABLE_TAKES, ENABLED, EFFORT, POSITION, LARGEST = range(7)  # tests/devices/handled_driver.c
SPACE, CTRL_C, CTRL_Z = b" ", b"\x03", b"\x1a"
REPEATS_S = 0.03  # repeat interval of a held key
ONE_FIFTH_N = 0.2 * 8.0


def take_terminal():
    os.setsid()
    fcntl.ioctl(0, termios.TIOCSCTTY, 0)


class Terminal(DeviceTest):
    """Commissioning of a device of one axis; the test acts as the person."""

    def begin_program(self, *device):
        self.file = self.config_file("devices", "desktop-3axis", axes=["x"])
        self.terminal, theirs = pty.openpty()
        self.program = subprocess.Popen(
            [BINARY, "device", "commission", "--operator", "A", "--device", self.file, *device],
            cwd=self.folder, stdin=theirs, stdout=theirs, stderr=theirs, preexec_fn=take_terminal)
        os.close(theirs)
        self.addCleanup(self.program.wait)
        self.addCleanup(self.program.kill)
        self.addCleanup(self.hang_up)
        self.said = ""

    def hang_up(self):
        if self.terminal is not None:
            os.close(self.terminal)
        self.terminal = None

    def listen(self, within_s=0.0):
        if select.select([self.terminal], [], [], within_s)[0]:
            try:
                self.said += os.read(self.terminal, 4096).decode()
            except OSError:  # the program has closed the terminal
                time.sleep(0.01)

    def until(self, what, press=b"", within_s=HANG_S):
        """Waits for an output and returns it; keeps a key pressed meanwhile. A busy machine may be so late that a press
        ends, and with it the step: then the step is repeated, as a person would do."""
        deadline = time.monotonic() + within_s
        while not (what() if callable(what) else re.search(what, self.said)):
            self.assertLess(time.monotonic(), deadline, f"{what}: {self.said}")
            if press:
                ended = re.search(r"the key was let go(.|\n)*Next: \w+.*quit:", self.said)
                self.said = self.said[ended.end():] if ended else self.said
                os.write(self.terminal, b"\n" if ended else press)
            self.listen(REPEATS_S)
        if callable(what):
            return ""
        end = re.search(what, self.said).end()
        heard, self.said = self.said[:end], self.said[end:]
        return heard

    def answer(self, question, text):
        heard = self.until(question)
        os.write(self.terminal, text.encode() + b"\n")
        return heard

    def ended(self, within_s=HANG_S):
        """Waits for the end and returns the exit code; the remaining output is in `said`."""
        self.until(lambda: self.program.poll() is not None, within_s=within_s)
        self.listen()
        return self.program.returncode


class Commission(Terminal):
    """One rail behind a driver."""

    def setUp(self):
        super().setUp()
        with open(self.write("rail", bytes(64)), "r+b") as shared:
            self.rail = mmap.mmap(shared.fileno(), 64)
        self.begin_program("--driver", DRIVERS / "handled.so", "--driver-settings", self.folder / "rail")

    def shared(self, at):
        return struct.unpack_from("d", self.rail, 8 * at)[0]

    def set(self, at, value):
        struct.pack_into("d", self.rail, 8 * at, value)

    def carry(self, to):
        """Moves the rail by hand, in steps far below those that look like an encoder that wraps round."""
        time.sleep(0.05)
        while abs(self.shared(HAND) - to) > 1e-9:
            step = max(-0.004, min(0.004, to - self.shared(HAND)))
            self.set(HAND, self.shared(HAND) + step)
            time.sleep(0.01)
        time.sleep(0.05)

    def begin(self):
        """Runs up to the push by hand."""
        self.answer("serial number H-1.*yes or no", "yes")
        self.answer("NOBODY attached.*yes or no", "yes")
        self.until("Push axis x away from you", press=SPACE)  # the key permits homing
        self.carry(0.012)
        os.write(self.terminal, b"\n")

    def begin_gravity(self):
        """Runs up to the first long move."""
        self.begin()
        self.until("Move axis x", press=SPACE)
        self.carry(-0.061)
        self.carry(0.061)
        os.write(self.terminal, b"0.122\n")
        self.until("Hold the space bar: what carries axis x")

    def expect_let_go(self):
        self.assertEqual((self.shared(ENABLED), self.shared(EFFORT)), (0.0, 0.0), self.said)
        self.assertLessEqual(self.shared(LARGEST), ONE_FIFTH_N + 1e-9, ALWAYS)

    def test_held_key_moves_and_releasing_it_leads_to_neutral(self):
        self.begin()
        self.until("Hold the space bar: axis x is pushed")
        time.sleep(0.3)
        self.assertEqual(self.shared(LARGEST), 0.0, ALWAYS + "no effort before the key is held")
        self.until("- effort moves it -", press=SPACE)
        self.assertGreater(self.shared(LARGEST), 0.0)
        self.answer("Move axis x", "0.12 m")
        self.until("no number")
        self.carry(-0.061)
        self.carry(0.061)
        self.answer("measure how far", "0.122")
        self.until("Hold the space bar: what carries axis x")
        self.until(lambda: self.shared(ENABLED) == 1.0 and self.shared(EFFORT) != 0.0, press=SPACE)
        self.until("the key was let go")  # the test no longer holds it
        self.until(lambda: self.shared(ENABLED) == 0.0)
        self.expect_let_go()
        self.answer("Next: gravity.*quit:", "gravitation")
        self.answer(r"gravitation is no step\.\s+Next: gravity.*quit:", "quit")
        self.assertEqual(self.ended(), 1)
        self.assertIn("Not finished", self.said)
        self.assertEqual([n for n in self.names_in(self.folder) if "passport" in n], [])

    def test_axis_that_is_not_pushed_is_named_and_the_step_repeated(self):
        self.answer("serial number H-1.*yes or no", "yes")
        self.answer("NOBODY attached.*yes or no", "yes")
        self.until("Push axis x.*Enter", press=SPACE)
        self.answer("", "")
        self.until("x: its position did not change while it was pushed")
        self.answer("Next: signs.*quit:", "")
        self.until("Step 3 of 12: signs")

    def test_device_is_moved_with_the_priority_of_the_loop(self):
        """Otherwise it reports that this machine does not grant it."""
        ask = "import os; os.sched_setscheduler(0, os.SCHED_FIFO, os.sched_param(80))"
        granted = subprocess.run([sys.executable, "-c", ask], stderr=subprocess.DEVNULL).returncode == 0
        self.until("serial number H-1.*yes or no")
        if granted:
            self.assertEqual(os.sched_getscheduler(self.program.pid), os.SCHED_FIFO)
            self.assertEqual(os.sched_getparam(self.program.pid).sched_priority, 80)
        else:
            self.assertRegex(self.said, "real-time priority: ")

    def test_interrupt_while_waiting_for_the_key_ends_the_program(self):
        self.begin()
        self.until("Hold the space bar")
        os.write(self.terminal, CTRL_C)
        self.assertEqual(self.ended(), 1)
        self.assertEqual(self.shared(LARGEST), 0.0)

    def test_every_end_during_a_motion_leads_to_neutral(self):
        for what, end in (("Ctrl-C", lambda: os.write(self.terminal, CTRL_C)),
                          ("Ctrl-Z", lambda: os.write(self.terminal, CTRL_Z)),
                          ("a polite kill", lambda: self.program.send_signal(signal.SIGTERM)),
                          ("a closed terminal", self.hang_up)):
            self.begin_gravity()
            self.until(lambda: abs(self.shared(EFFORT)) > 0.01, press=SPACE)
            end()
            if self.terminal is None:
                self.program.wait(timeout=HANG_S)
            else:
                self.assertEqual(self.ended(), 1, what)
            self.expect_let_go()
            self.doCleanups()
            self.setUp()

    def test_key_released_during_enabling_moves_nothing(self):
        self.set(ENABLE_TAKES, 1.5)
        self.begin()
        self.until("Hold the space bar")
        os.write(self.terminal, SPACE * 30)  # wait in the terminal while the device is being enabled
        self.until("the key was let go")
        self.assertEqual(self.shared(LARGEST), 0.0, ALWAYS)
        self.expect_let_go()

    def test_nobody_attached_is_confirmed_only_by_an_answer_to_its_question(self):
        """Input from before the question, or input other than yes or no, is no answer."""
        self.until("serial number H-1.*yes or no")
        os.write(self.terminal, b"yes\nyes\n\n")
        self.until("NOBODY attached.*yes or no")
        time.sleep(0.3)
        self.listen()
        self.assertNotIn("signs", self.said)
        os.write(self.terminal, b"sure\n")
        self.until("NOBODY attached.*yes or no")
        self.answer("", "  no")
        self.until("somebody is attached")
        self.assertEqual(self.shared(LARGEST), 0.0)


class Learned(Terminal):
    """At the simulated plant, without driver and device, the instructions alone lead to the end."""

    def setUp(self):
        super().setUp()
        self.begin_program("--simulated")

    def answer_as_said(self, question, said):
        """Answers with the number that was printed before the question."""
        heard = self.until(question, press=SPACE)
        time.sleep(0.3)  # the person releases the key
        os.write(self.terminal, re.findall(said, heard)[-1].encode() + b"\n")

    def begin(self):
        self.answer("serial number simulated.*yes or no", "yes")
        self.answer("NOBODY attached.*yes or no", "yes")
        self.until("leave it there; Enter", press=SPACE)
        time.sleep(0.3)
        os.write(self.terminal, b"\n")

    def test_motors_push_only_while_the_key_is_held(self):
        self.begin()
        self.until("Hold the space bar: axis x is pushed")
        self.until("- effort moves it -", press=SPACE)
        self.until("measure how far")
        os.write(self.terminal, CTRL_C)
        self.assertEqual(self.ended(), 1)
        self.assertEqual([n for n in self.names_in(self.folder) if "passport" in n], [])

    def test_all_steps_lead_to_a_passport_marked_as_simulated_slow(self):
        self.begin()
        self.answer_as_said("measure how far", r"ruler reads ([\d.]+) m")
        self.answer_as_said("its force", r"pulls axis x with ([\d.]+) N")
        self.until("Release it; Enter", press=SPACE)
        time.sleep(0.3)
        os.write(self.terminal, b"\n")
        self.until("no device is armed with it", press=SPACE)
        self.assertEqual(self.ended(), 0)
        passport = self.file.with_suffix(".simulated.passport.toml")
        self.assertIn("\nsimulated = true", passport.read_text())
        self.expect(self.run_app("validate", passport), 0)


if __name__ == "__main__":
    main()
