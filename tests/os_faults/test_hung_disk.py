"""No stop waits while a disk hangs, whatever its source. disk_faults.cpp makes the disk hang, like a share whose server
is gone.

The measured time is from sending the stop to the loop's first tick of the fade or the ramp. The due time of that tick
follows from its number: ticks are a period apart, and the earliest arrival of any state gives the time of tick 0, so
that delays of the network and of the observer do not count."""
import fcntl
import http.client
import itertools
import os
import signal
import threading
import time
import unittest
import urllib.error
import urllib.request

from faulty_disk import CALLS, LIBRARY, FaultyDisk
import client
from app import ALWAYS, FREE_RUN, FULL, HANG_S, INTERRUPTED, SOURCE, STOP_REQUESTED, PacedTest, main, read_recording

EMERGENCY, HOLDER_SILENT = 1 << 11, 1 << 20  # docs/recording.md, bits of `faults`
BEGUN = STOP_REQUESTED | EMERGENCY | HOLDER_SILENT

WITHIN_S = 0.050
FADE_S, RAMP_S = 0.35, 0.100  # docs/safety.md: a plain stop fades the exercise out, then ramps

PLACES = ("recording", "download", "report", "page", "log")
STOP_SOURCES = ("emergency stop of a page", "stop of a page", "emergency stop of a game", "stop of a game", "SIGINT",
         "SIGTERM", "page that is closed", "page that falls silent")
RATE_HZ = 500  # rate of states to the observer: every second tick


def listen_to_ctrl_c():
    """Restores the default handling of Ctrl-C, which a shell's background jobs ignore."""
    signal.signal(signal.SIGINT, signal.SIG_DFL)


@unittest.skipUnless(LIBRARY, "without the library that makes a disk hang")
class Stops(PacedTest):
    def start(self, *arguments, ms=5000, place="recording", report=False):
        self.disk = FaultyDisk(self.folder, ms)
        kept = self.folder / "out/recordings"
        kept.mkdir(parents=True, exist_ok=True)
        folders = {"recording": [self.folder / "rec"], "log": [self.folder / "rec"],
                   "page": [SOURCE / "web/dist"]}.get(place, [kept])
        (self.folder / "rec").mkdir(exist_ok=True)
        environment = self.disk.environment(*folders)
        if place in ("download", "report") and not (kept / "old.h5").exists():
            os.replace(self.record("old.h5", duration=0.3), kept / "old.h5")
        # A recording held by a program that hangs is not overwritten.
        (self.folder / "rec/run.h5").unlink(missing_ok=True)
        run = self.start_app("run", "--port", 0, "--udp", 0, "--udp-key", client.Game.KEY, "--record", "rec/run.h5", "--duration", 600,
                             "--no-rehearsal", *arguments, env=environment, preexec_fn=listen_to_ctrl_c)
        self.addCleanup(self.disk.hang)
        self.port = int(run.stdout.readline().split(":")[2].rstrip("/\n"))
        while "udp " not in (line := run.stdout.readline()):
            self.assertIsNone(run.poll(), line)
        self.assertGreater(self.disk.loaded, 0, "the disk cannot hang: disk_faults.cpp is not in the program")
        self.game = client.Game(int(line.split(":")[1]), RATE_HZ)
        self.addCleanup(self.game.close)
        # Waits until it renders with full authority.
        self.wait_until(run, lambda: self.game.states and self.game.states[-1][3] == 1.0 and self.game.states[-1][1] > 400)
        return run

    def url(self, path):
        return f"http://127.0.0.1:{self.port}{path}"

    def browse(self, path):
        """Requests a path without waiting; returns a list that gets the status later."""
        def ask():
            try:
                with urllib.request.urlopen(self.url(path), timeout=HANG_S) as answer:
                    answer.read()
                    statuses.append(answer.status)
            except urllib.error.HTTPError as error:
                statuses.append(error.code)
            except (OSError, http.client.HTTPException):
                statuses.append(0)
        statuses = []
        threading.Thread(target=ask, daemon=True).start()
        return statuses

    def expect_said(self, run, text):
        """Waits for a text on standard error."""
        os.set_blocking(run.stderr.fileno(), False)
        said, until = b"", time.monotonic() + HANG_S
        while text.encode() not in said and time.monotonic() < until:
            try:
                said += os.read(run.stderr.fileno(), 4096)
            except BlockingIOError:
                time.sleep(0.01)
        self.assertIn(text, said.decode())

    def fill_log(self, run):
        """Fills the pipe of the program's output, which nobody reads."""
        with open(f"/proc/{run.pid}/fd/1", "wb", buffering=0, opener=lambda p, f: os.open(p, f | os.O_NONBLOCK)) as pipe:
            fcntl.fcntl(run.stdout, fcntl.F_SETPIPE_SZ, 4096)
            while pipe.write(b"x" * 512):
                pass

    def busy_with(self, run, place, call):
        """Waits until a part of the program hangs in that call, if it makes the call at all."""
        if place == "log":
            self.fill_log(run)
            self.browse("/none/%00")  # the refusal is logged
        self.disk.hang(call)
        paths = {"download": ["/api/recordings", "/api/recordings/old.h5"],
                 "report": ["/api/recordings/old.h5/report/"], "page": ["/", "/console"]}.get(place, [])
        self.statuses = [self.browse(path) for path in paths for _ in range(2)]
        # The recorder allocates space every few seconds; a call that the program never makes cannot hang.
        until = time.monotonic() + (0.6 if place != "recording" else 8.0 if call == "fallocate" else 1.2)
        while not self.disk.hanging and time.monotonic() < until:
            time.sleep(0.005)
        time.sleep(self.random.uniform(0.02, 0.1))

    def prepare(self, run, source):
        """Connects the client that will stop; it takes the controls if the stop needs them."""
        if source == "stop of a game":
            self.game.say(client.TAKE_CONTROLS)
            self.wait_until(run, lambda: self.game.holds_controls)
        if "page" in source:
            self.page = client.Page(self.port)
            self.addCleanup(self.page.socket.close)
            if not source.startswith("emergency"):
                self.page.hold_controls()
        time.sleep(0.1)

    def send(self, run, source):
        """Sends the stop. Returns when it was sent, and the longest delay of its effect."""
        now = time.monotonic()
        if source == "emergency stop of a page":
            self.page.say(client.EMERGENCY_STOP)
        elif source == "stop of a page":
            self.page.say(client.STOP)
        elif source == "emergency stop of a game":
            self.game.say(client.EMERGENCY_STOP)
        elif source == "stop of a game":
            self.game.say(client.STOP)
        elif source.startswith("SIG"):
            run.send_signal(getattr(signal, source))
        elif source == "page that is closed":
            self.page.close()
        else:
            return self.page.fall_silent(), 0.2 + 0.05  # its last heartbeat was up to 50 ms ago
        return now, 0.0

    def first(self, since, bits):
        """Delay of the first tick with one of these bits; None if there is none yet."""
        states = list(self.game.states)
        origin = min(came - tick * 1e-3 for came, tick, _, _ in states if tick > 0)  # tick 0 also precedes the loop
        ticks = [tick for _, tick, faults, _ in states if faults & bits]
        return origin + ticks[0] * 1e-3 - since if ticks else None

    def delay(self, source, place, call, ms):
        run = self.start(place=place, ms=ms)
        self.prepare(run, source)
        self.assertIsNone(self.first(0.0, BEGUN), "it stopped by itself")
        self.busy_with(run, place, call)
        hung = self.disk.hanging
        since, grace = self.send(run, source)
        self.wait_until(run, lambda: self.first(since, BEGUN) is not None)
        delay = self.first(since, BEGUN)
        self.assertIsNotNone(delay, ALWAYS + "nothing stopped")
        ramp = None
        if "closed" not in source and "silent" not in source:  # these fade the exercise out, and rendering continues
            self.wait_until(run, lambda: self.first(since, STOP_REQUESTED) is not None)
            ramp = self.first(since, STOP_REQUESTED)
            self.assertIsNotNone(ramp, ALWAYS + "it faded, and never ramped")
        run.kill()
        self.disk.hang()
        return delay - grace, ramp, hung

    def check(self, source, place, call, ms):
        delay, ramp, hung = self.delay(source, place, call, ms)
        what = f"{source}, {call} hangs, {place}"
        print(f"figure: {what}: {1e3 * delay:.0f} ms ({hung} calls hung)", flush=True)
        self.assertLessEqual(delay, WITHIN_S, what)
        if ramp is not None:
            self.assertLessEqual(ramp, WITHIN_S + (0.0 if source.startswith("emergency") else FADE_S), what)

    def test_every_stop_begins_within_50_ms_while_a_disk_hangs(self):
        combinations = list(itertools.product(STOP_SOURCES, PLACES, CALLS))
        self.random.shuffle(combinations)
        if not FULL:
            del combinations[2:]
            # Combinations that once waited: for the server's thread, for telemetry, for the main thread.
            combinations += [("emergency stop of a page", "download", "read"), ("stop of a page", "recording", "pwrite"),
                             ("SIGTERM", "recording", "pwrite")]
        for source, place, call in combinations:
            with self.subTest(source=source, place=place, call=call):
                self.check(source, place, call, 5000 if FULL else 2000)

    def test_second_ctrl_c_reports_what_is_waited_for_and_the_third_ends_it(self):
        run = self.start(ms=20000)
        self.busy_with(run, "recording", "pwrite")
        self.assertGreater(self.disk.hanging, 0)
        run.send_signal(signal.SIGINT)
        self.wait_until(run, lambda: self.game.states[-1][3] == 0.0)
        time.sleep(1.0)
        self.assertIsNone(run.poll(), "it waits for the disk")
        run.send_signal(signal.SIGINT)
        self.expect_said(run, "waiting for the disk: recording rec/run.h5")
        run.send_signal(signal.SIGINT)
        began = time.monotonic()
        run.wait(timeout=HANG_S)
        self.assertLess(time.monotonic() - began, 10.0, "it ends before the disk answers")
        self.assertEqual(run.returncode, INTERRUPTED)
        with read_recording(self.folder / "rec/run.h5") as recording:  # the ticks from before the disk hung
            self.assertEqual(len(recording["ticks/tick"]) % 1000, 0)

    def test_run_without_pages_stops_and_reports_the_same(self):
        self.disk = FaultyDisk(self.folder, 20000)
        self.addCleanup(self.disk.hang)
        run = self.start_app(*FREE_RUN, "--duration", 600, "--record", "rec/run.h5", "--no-rehearsal",
                             env=self.disk.environment(self.folder / "rec"), preexec_fn=listen_to_ctrl_c)
        self.wait_until_it_renders(run)
        self.busy_with(run, "recording", "pwrite")
        for _ in range(2):
            run.send_signal(signal.SIGTERM)
            time.sleep(0.5)
        self.expect_said(run, "waiting for the disk: recording rec/run.h5")
        run.send_signal(signal.SIGTERM)
        run.wait(timeout=HANG_S)
        self.assertEqual(run.returncode, INTERRUPTED)

    def test_disk_that_recovers_loses_no_tick(self):
        run = self.start(ms=1500)
        self.busy_with(run, "recording", "pwrite")
        self.disk.hang()
        run.send_signal(signal.SIGINT)
        said, complained = run.communicate(timeout=HANG_S)
        self.assertEqual(run.returncode, INTERRUPTED, said + complained)
        self.assertNotIn("dropped", said)
        with read_recording(self.folder / "rec/run.h5") as recording:
            self.assertEqual(recording["ticks/authority"][-1], 0.0)
        self.expect_same_when_run_again("rec/run.h5")

    def test_requests_to_a_hung_disk_are_refused_and_pages_are_served(self):
        run = self.start(place="download", ms=4000)
        self.disk.hang("read", "open", "stat")
        asked = [self.browse("/api/recordings/old.h5") for _ in range(24)]
        time.sleep(1.0)
        self.assertEqual([s for s in asked if s == [503]], [[503]] * 8)  # at most 16 requests wait
        with urllib.request.urlopen(self.url("/healthz"), timeout=HANG_S) as health:
            self.assertEqual(health.status, 200)
        page = self.browse("/")
        self.wait_until(run, lambda: page)
        self.assertIn(page[0], (200, 503))  # 503 if the pages are not built; answered at once
        self.disk.hang()

    def test_stop_after_200_other_commands_is_obeyed_in_time(self):
        for flood in (200, 2000):
            run = self.start()
            page = client.Page(self.port)
            self.addCleanup(page.socket.close)
            page.hold_controls()
            time.sleep(0.1)
            numbers = [page.act(3) for _ in range(flood // 2)]
            since, stop = time.monotonic(), page.say(client.STOP)
            numbers += [page.act(3) for _ in range(flood // 2)]
            self.assertEqual(page.answer(stop), (True, ""))
            self.wait_until(run, lambda: self.first(since, BEGUN) is not None)
            self.assertLess(self.first(since, BEGUN), 10 * WITHIN_S)  # it was sent after all the others
            refused = {n: page.answer(n)[1] for n in numbers if page.answer(n, 5.0) and not page.answer(n)[0]}
            for number, reason in refused.items():
                self.assertTrue(reason, number)
            page.close()
            run.kill()

    def test_report_being_made_does_not_delay_the_end_of_the_program(self):
        run = self.start(place="report", ms=20000)
        self.disk.hang("read")
        report = self.browse("/api/recordings/old.h5/report/")
        self.wait_until(run, lambda: self.disk.hanging > 0)
        run.send_signal(signal.SIGINT)
        began = time.monotonic()
        self.wait_until(run, lambda: time.monotonic() - began > 12.0)
        self.assertEqual(run.poll(), INTERRUPTED, report)


if __name__ == "__main__":
    main()
