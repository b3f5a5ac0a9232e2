"""A driver whose call does not return: page, terminal and /healthz say so, nothing soothes, and a third Ctrl-C ends."""
import json
import queue
import re
import signal
import threading
import time
import urllib.error
import urllib.request

import client
from app import HANG_S, INTERRUPTED, main
from device_app import DRIVERS, HARDWARE, DeviceTest
from test_commission import Terminal

ALARM = "The robot does not answer. Press the emergency stop on the device now."
RUN_STATE, RENDERING, STOPPING, STOPPED = 4, 1, 2, 3
SILENT_AFTER_S = 0.050  # docs/safety.md, "A loop or a driver that does not answer"


class Hang(DeviceTest):
    def start(self, call):
        self.file = self.folder / "hangs"
        self.file.unlink(missing_ok=True)
        self.run_ = self.start_run(*self.desktop(), "--driver", DRIVERS / "hanging.so", "--driver-settings",
                                   f"{call} {self.file}")
        self.addCleanup(self.file.unlink, missing_ok=True)
        self.port = self.page.socket.getpeername()[1]
        self.states, self.lines = [], queue.Queue()
        self.page.on_state = lambda state: self.states.append((time.monotonic(), state))
        threading.Thread(target=self.read_terminal, daemon=True).start()

    def read_terminal(self):
        try:
            for line in self.run_.stdout:
                self.lines.put((time.monotonic(), line))
        except ValueError:  # closed
            pass

    def hang(self):
        """Makes the call hang; returns when, and how many states had come."""
        self.file.touch()
        return time.monotonic(), len(self.states)

    def health(self):
        try:
            with urllib.request.urlopen(f"http://127.0.0.1:{self.port}/healthz", timeout=HANG_S) as answer:
                return answer.status, json.load(answer)
        except urllib.error.HTTPError as error:
            return error.code, json.load(error)

    def flag(self, field):
        return self.page.state is not None and bool(self.page.state.number(field, "B"))

    def run_state(self):
        return self.page.state.number(RUN_STATE, "b")

    def wait(self, what):
        self.wait_until(self.run_, what)

    def wait_for_line(self, words):
        until = time.monotonic() + HANG_S
        while time.monotonic() < until:
            at, line = self.lines.get(timeout=HANG_S)
            if words in line:
                return at
        self.fail(f"the terminal never says: {words}")

    def expect_alarm(self, call, state):
        """Hangs; expects the alarm on page, terminal and health."""
        began, before = self.hang()
        while (health := self.health())[0] != 503 or health[1]["alarm"] is None:
            self.assertLess(time.monotonic() - began, HANG_S, health)
        healthy_until = time.monotonic()
        self.assertEqual((health[1]["alarm"], health[1]["healthy"]), (ALARM, False))
        self.wait(lambda: self.flag(client.SILENT))
        shown, first = next((at, state) for at, state in self.states[before:] if state.number(client.SILENT, "B"))
        said = self.wait_for_line(ALARM)
        if call in ("read", "write") and state != "not armed":
            self.assertGreaterEqual(first.number(client.LOOP_AGE, "f", -1.0), SILENT_AFTER_S - 1e-6)
        began = int(self.file.with_suffix(".at").read_text()) * 1e-9  # the driver's call was entered
        print(f"figure: {call} hangs, {state}: page {1e3 * (shown - began):.0f} ms, terminal {1e3 * (said - began):.0f} ms, "
              f"health {1e3 * (healthy_until - began):.0f} ms")
        return self.states.index((shown, first))

    def expect_no_false_word(self, since):
        """From the alarm on, every state and every answer of /healthz is the alarm."""
        for _ in range(5):
            self.assertEqual((self.health()[0], self.health()[1]["alarm"]), (503, ALARM))
            time.sleep(0.05)
        false = [state.number(RUN_STATE, "b") for _, state in self.states[since:] if not state.number(client.SILENT, "B")]
        self.assertEqual(false, [], "states without the alarm")

    def arm_and_render(self):
        self.arm()
        self.wait_for_ticks(self.run_, 400)
        self.assertFalse(self.flag(client.SILENT))
        self.assertEqual(self.health()[0], 200)
        self.states.clear()

    def test_call_that_hangs_while_rendering_is_the_alarm_and_no_stop_is_confirmed(self):
        for call, stop in (("read", client.STOP), ("write", client.EMERGENCY_STOP)):
            with self.subTest(call=call):
                self.start(call)
                self.arm_and_render()
                since = self.expect_alarm(call, "rendering")
                self.expect_no_false_word(since)
                self.assertEqual(self.page.answer(self.page.say(stop)), (True, ""), "the stop is heard")
                self.wait(lambda: self.run_state() == STOPPING)
                self.assertTrue(self.flag(client.STOP_PENDING), "and not obeyed")
                self.wait(lambda: self.flag(client.STOP_UNCONFIRMED))
                self.expect_no_false_word(since)
                # The device answers again, and the loop obeys the stop that it was asked for.
                self.file.unlink()
                self.wait_for_line("The robot answers again.")
                self.wait(lambda: self.run_state() not in (RENDERING, STOPPING))
                self.assertFalse(self.flag(client.SILENT) or self.flag(client.STOP_PENDING))
                self.run_.kill()

    def hangs_in_the_ramp(self):
        self.states.clear()
        stop = self.page.say(client.EMERGENCY_STOP)
        self.file.touch()
        self.assertTrue(self.page.answer(stop)[0])
        self.wait(lambda: self.flag(client.SILENT) or self.run_state() == STOPPED)
        return self.run_state() == STOPPING

    def test_call_that_hangs_during_the_ramp_is_the_alarm(self):
        for call in ("read", "write"):
            with self.subTest(call=call):
                self.start(call)
                self.arm_and_render()
                # The ramp takes 80 ms: a busy machine may miss it.
                while not self.hangs_in_the_ramp():
                    self.file.unlink()
                    self.arm(self.page.state.number(client.ENDINGS, "I"))
                    self.wait_for_ticks(self.run_, 400)
                since = next(i for i, (_, state) in enumerate(self.states) if state.number(client.SILENT, "B"))
                self.wait_for_line(ALARM)
                self.expect_no_false_word(since)
                self.run_.kill()

    def test_call_that_hangs_while_nothing_renders_is_the_alarm(self):
        self.start("read")
        self.wait(lambda: self.page.state is not None)
        self.page.say(client.ARM, ("I", 1), ("I", self.page.basis()))  # reads the device first; its answer never comes
        self.expect_no_false_word(self.expect_alarm("read", "not armed"))

    def test_device_that_cannot_be_enabled_or_disabled_is_the_alarm(self):
        self.start("enable")
        self.wait(lambda: self.page.state is not None)
        self.page.say(client.ARM, ("I", 1), ("I", self.page.basis()))
        self.expect_no_false_word(self.expect_alarm("enable", "arming"))
        self.run_.kill()
        self.start("disable")
        self.arm_and_render()
        self.page.say(client.EMERGENCY_STOP)
        self.expect_no_false_word(self.expect_alarm("disable", "at neutral"))

    def test_stop_of_a_loop_that_ticks_is_obeyed_and_is_no_alarm(self):
        self.start("read")
        self.arm_and_render()
        self.assertTrue(self.page.answer(self.page.say(client.EMERGENCY_STOP))[0])
        self.wait(lambda: self.run_state() == STOPPED)
        self.assertFalse(any(state.number(client.STOP_UNCONFIRMED, "B") for _, state in self.states))
        self.assertFalse(self.flag(client.SILENT) or self.flag(client.STOP_PENDING))
        self.assertEqual(self.health()[0], 200)

    def test_third_signal_ends_the_program_although_the_driver_hangs(self):
        for number in (signal.SIGINT, signal.SIGTERM):
            with self.subTest(number=number):
                self.start("write")
                self.arm_and_render()
                self.expect_alarm("write", "rendering")
                time.sleep(0.3)  # more than the 0.2 s after which the third signal waits no longer
                for said in ("", "once more ends the program", "ended, although the loop does not answer"):
                    self.run_.send_signal(number)
                    while said and said not in (line := self.run_.stderr.readline()):
                        self.assertTrue(line, said)
                    self.assertTrue(not said or "Press the emergency stop on the device now" in line)
                    time.sleep(0.05)
                self.run_.wait(timeout=HANG_S)
                self.assertEqual(self.run_.returncode, INTERRUPTED)


class Opening(DeviceTest):
    """While a driver opens or closes, only the terminal can say that it does not answer."""

    def start(self, call, hangs):
        self.file = self.folder / "hangs"
        self.file.unlink(missing_ok=True)
        if hangs:
            self.file.touch()
        self.run_ = self.start_app(*HARDWARE, "--without-passport", *self.desktop(), "--driver", DRIVERS / "hanging.so",
                                   "--driver-settings", f"{call} {self.file}")
        self.addCleanup(self.file.unlink, missing_ok=True)

    def read_until(self, words):
        said = ""
        while words not in said:
            line = self.run_.stdout.readline()
            self.assertTrue(line, said)
            said += line
        return said

    def test_call_that_hangs_while_opening_is_the_alarm_until_it_returns(self):
        for call in ("open", "describe", "identify"):
            with self.subTest(call=call):
                self.start(call, True)
                self.assertNotIn("http", self.read_until(ALARM))
                self.file.unlink()
                self.read_until("The robot answers again.")
                self.read_until("http")
                self.run_.kill()

    def test_call_that_hangs_while_closing_is_the_alarm_until_it_returns(self):
        self.start("close", False)
        self.read_until("NOBODY MAY BE ATTACHED")
        self.file.touch()
        self.run_.send_signal(signal.SIGINT)
        self.read_until(ALARM)
        self.file.unlink()
        self.assertEqual(self.run_.wait(timeout=HANG_S), INTERRUPTED)


class Commissioning(Terminal):
    """A driver that hangs while its device is commissioned."""

    def begin_hanging(self, *more):
        self.file_of_hang = self.folder / "hangs"
        self.begin_program("--driver", DRIVERS / "hanging.so", "--driver-settings", f"read {self.file_of_hang}", *more)

    def test_terminal_says_it_until_the_driver_answers_again(self):
        self.begin_hanging()
        self.until("serial number hangs-1")
        self.file_of_hang.touch()
        self.until(ALARM)
        self.file_of_hang.unlink()
        self.until("The robot answers again")

    def test_page_and_health_say_it(self):
        self.begin_hanging("--web", "--port", "0")
        port = int(re.search(r":(\d+)/commission", self.until(r":\d+/commission"))[1])
        page = client.Page(port)
        wait = lambda what: self.until(lambda: page.state is not None and what())
        wait(lambda: not page.state.number(client.SILENT, "B"))
        self.file_of_hang.touch()
        wait(lambda: page.state.number(client.SILENT, "B"))
        with self.assertRaises(urllib.error.HTTPError) as health:
            urllib.request.urlopen(f"http://127.0.0.1:{port}/healthz", timeout=HANG_S)
        self.assertEqual(json.load(health.exception)["alarm"], ALARM)
        self.file_of_hang.unlink()
        wait(lambda: not page.state.number(client.SILENT, "B"))


if __name__ == "__main__":
    main()
