"""`wholehand device-host` and `wholehand run --host`: if the loop dies, the device does not keep pushing.

The driver stores every effort of the host with its time (tests/devices/pushed_driver.c). The host may be as late as
this machine delays it: its gaps between two writes are added to the allowed time.
"""
import json
import os
import pathlib
import re
import signal
import struct
import subprocess
import time

import client
from app import ALWAYS, BINARY, CONFIG, FULL, HANG_S, main, read_recording
from device_app import DRIVERS, HARDWARE, DeviceTest, rails_commissioned

STALE_SAMPLE, ENABLE_LOST, SAMPLE_DELAY = 1 << 25, 1 << 24, 1 << 28  # docs/recording.md, bits of `faults`
LOSSES = 25 if FULL else 2
RECORD = struct.Struct("<q3d")
NAME = f"test-apps-{os.getpid()}"
EFFORTS = pathlib.Path("/dev/shm", NAME + "-efforts.bin")  # in memory, because a busy disk would delay the host


def points_alike(a, b):
    """Whether two efforts differ by a factor only, within rounding, and are not neutral."""
    return any(a) and all(abs(a[i] * b[j] - a[j] * b[i]) <= 1e-9 * max(map(abs, a)) * max(map(abs, b))
                          for i in range(len(a)) for j in range(i))


class DeviceHost(DeviceTest):
    def setUp(self):
        super().setUp()
        self.sessions = 0
        for leftover in (NAME, NAME + ".lock"):
            self.addCleanup(pathlib.Path("/dev/shm", "wholehand-" + leftover).unlink, missing_ok=True)
        self.addCleanup(EFFORTS.unlink, missing_ok=True)

    def start_host(self, driver="pushed", settings=EFFORTS, device=(), more=()):
        """Starts a host whose output goes into a file, so that it is complete when the host is killed."""
        log = open(self.folder / "host.log", "a")
        self.addCleanup(log.close)
        before = self.host_says()
        self.host = host = subprocess.Popen([BINARY, "device-host", "--name", NAME, "--driver", DRIVERS / f"{driver}.so",
                                 "--driver-settings", settings, *(device or self.desktop()[:2]), *more], cwd=self.folder,
                                stdin=subprocess.DEVNULL, stdout=log, stderr=log)
        self.addCleanup(host.wait)
        self.addCleanup(host.kill)
        self.wait_until(host, lambda: self.host_says() != before)
        self.assertIn(f"{NAME}: holds", self.host_says())
        return host

    def host_says(self):
        log = self.folder / "host.log"
        return log.read_text() if log.exists() else ""

    def start_run(self):
        return super().start_run(*self.desktop(), "--host", NAME)

    def efforts(self):
        """(time in s, (x, y, z) in N) of the efforts in the file so far."""
        data = EFFORTS.read_bytes()
        return [(r[0] * 1e-9, r[1:]) for r in RECORD.iter_unpack(data[:len(data) // RECORD.size * RECORD.size])]

    def arm_until_it_pushes(self, run):
        """Arms until it pushes. If this machine delays loop or host, the other one stops, and it is armed again."""
        def pushes():
            given = self.efforts()
            return len(given) > 400 and all(max(map(abs, e)) > 0.5 for _, e in given[-400:])

        def is_over():
            session = self.host_says()[before:].partition(f": enabled by process {run.pid}\n")[2]
            return re.search("LETS GO|stays there|: ended\n", session)
        for _ in range(20):
            before = len(self.host_says())
            self.arm_anew()
            self.wait_until(run, lambda: pushes() or is_over())
            if not is_over():
                return
        self.fail(f"never pushes\n{self.host_says()}")

    def arm_anew(self):
        """Arms again after any ending."""
        for _ in range(50):
            self.wait_until(self.host, lambda: self.page.state is not None)
            accepted, reason = self.page.arm(self.page.state.number(client.ENDINGS, "I"))
            if accepted:
                self.sessions += 1
                return
            time.sleep(0.1)
        self.fail(reason)

    def is_calm(self, given):
        """Whether loop and host gave a new effort every 3 ms in the last 0.2 s, so that nothing is blended in."""
        changes = [b[0] for a, b in zip(given, given[1:]) if b[1] != a[1] and b[0] > given[-1][0] - 0.2]
        return all(b - a < 0.003 for a, b in zip(changes, changes[1:]))

    def judge_loss(self, host):
        """Checks the last loss, from the loop's last command on."""
        self.wait_until(host, lambda: "stays there" in self.host_says().splitlines()[-1], self.host_says)
        self.wait_until(host, lambda: self.efforts()[-1][1] == (0.0, 0.0, 0.0), self.host_says)
        given = self.efforts()
        neutral = len(given)
        while neutral > 0 and given[neutral - 1][1] == (0.0, 0.0, 0.0):
            neutral -= 1
        self.assertLess(neutral, len(given), ALWAYS + "never neutral")
        # The ramp changes with every write. The last command stays for some writes and points in the same direction.
        def is_ramp(a, b):
            return a != b and points_alike(a, given[neutral - 1][1])
        lowered = neutral
        while lowered > 1 and is_ramp(given[lowered - 2][1], given[lowered - 1][1]):
            lowered -= 1
        last = lowered - 1
        while last > 0 and given[last - 1][1] == given[last][1]:
            last -= 1
        span = given[last:neutral + 1]
        late = sum(b[0] - a[0] for a, b in zip(span, span[1:]) if b[0] - a[0] > 0.002)  # the host writes every 0.25 ms
        # A late host also received the last command late.
        around = given[max(0, last - 1):neutral + 1]
        gap = max(b[0] - a[0] for a, b in zip(around, around[1:]))
        taken = span[-1][0] - span[0][0]
        ramp = given[lowered - 1:neutral + 1]
        for (_, before), (_, after) in zip(ramp, ramp[1:]):
            for was, now in zip(before, after):
                self.assertLessEqual(abs(now), abs(was), ALWAYS + "an effort rises after the loss")
                self.assertGreaterEqual(now * was, 0.0, ALWAYS + "an effort goes through neutral")
        self.assertGreater(max(map(abs, span[0][1])), 0.05, "nothing was pushed: the test proves nothing")
        self.assertLessEqual(taken, 0.110 + late)
        self.calm = self.is_calm(given[:last + 1])
        if self.calm:
            self.assertGreater(given[lowered][0] - given[last][0], 0.019 - gap, "an alarm too early")
        return taken, gap

    def test_lost_loop_leads_to_neutral_and_the_next_loop_is_served(self):
        host = self.start_host()
        for number in (signal.SIGKILL, signal.SIGSTOP) * LOSSES:
            run = self.start_run()
            self.arm_until_it_pushes(run)
            run.send_signal(number)
            taken, gap = self.judge_loss(host)
            print(f"figure: loop of the program lost by {number.name}, neutral = {taken * 1e3:.1f} ms "
                  f"(longest gap of the host {gap * 1e3:.1f} ms{'' if self.calm else '; it or the loop was late before'})")
            said = self.host_says().splitlines()[-2:]
            self.assertIn("LETS GO: the loop sent no new command for 20 ms", said[0])
            self.assertIn("stays there until a loop arms anew", said[1])
            if number == signal.SIGSTOP:
                self.expect_stopped_loop_is_ignored(host, run)
            run.kill()
            run.communicate()

    def expect_stopped_loop_is_ignored(self, host, run):
        before = len(self.efforts())
        run.send_signal(signal.SIGCONT)
        self.wait_until(host, lambda: self.host_says().endswith(": ended\n"), self.host_says)
        after = self.efforts()[before:]
        self.assertTrue(all(e == (0.0, 0.0, 0.0) for _, e in after), ALWAYS + "the host obeys the loop after it let go")
        self.arm_until_it_pushes(run)  # after arming on purpose, the loop is served again

    def test_lost_host_is_a_fault_of_the_loop_and_a_new_host_serves_it(self):
        host = self.start_host()
        run = self.start_run()
        self.arm_until_it_pushes(run)
        lost = self.sessions - 1
        endings = self.page.state.number(client.ENDINGS, "I")
        host.kill()
        host.wait()
        accepted, reason = self.page.arm(endings_seen=endings + 1)
        self.assertFalse(accepted)
        self.assertIn("is gone", reason)
        self.assertIn("wholehand device-host", reason)
        self.start_host()
        self.arm_until_it_pushes(run)
        run.send_signal(signal.SIGINT)
        said = "".join(run.communicate(timeout=HANG_S))
        self.assertRegex(said, "rendering -> faulted: (stale sample|samples delayed)")
        self.assertIn(f"pushed, 3 axes, in the host {NAME}", self.driver_line)
        recordings = sorted((self.folder / "out/recordings").glob("*.h5"))
        with read_recording(recordings[lost]) as first:
            self.assertTrue(first["ticks/faults"][-1] & (STALE_SAMPLE | SAMPLE_DELAY))

    def test_end_of_the_loop_disables_and_end_of_the_host_goes_to_neutral(self):
        host = self.start_host()
        run = self.start_run()
        self.arm_until_it_pushes(run)
        before = len(self.host_says())
        run.send_signal(signal.SIGINT)
        run.communicate(timeout=HANG_S)
        self.wait_until(host, lambda: self.host_says().endswith(": ended\n"))
        self.assertNotIn("LETS GO", self.host_says()[before:])
        run = self.start_run()
        self.arm_until_it_pushes(run)
        host.terminate()
        self.assertEqual(host.wait(timeout=HANG_S), 0, self.host_says())
        self.assertIn("LETS GO: the host was asked to end", self.host_says())
        self.assertEqual(self.efforts()[-1][1], (0.0, 0.0, 0.0))
        self.assertFalse(pathlib.Path("/dev/shm/wholehand-" + NAME).exists())
        time.sleep(0.3)
        run.send_signal(signal.SIGINT)
        self.assertIn("faulted: ", "".join(run.communicate(timeout=HANG_S)))

    def listed(self):
        """This host in `device list`."""
        self.run_app("device", "list", "--json", "hosts.json")
        hosts = json.loads((self.folder / "hosts.json").read_text())["hosts"]
        return next(h for h in hosts if h["name"] == NAME)

    def test_drive_that_turns_off_is_shown_with_its_age(self):
        host = self.start_host("faulty", "enable@20000")  # from sample 20,000 on, 5 s, it says that it is not enabled
        loop = subprocess.Popen([BINARY.parent / "host_partner", "loop", NAME, "forever"], cwd=self.folder)
        self.addCleanup(loop.wait)
        self.addCleanup(loop.kill)
        self.wait_until(host, lambda: f"enabled by process {loop.pid}" in self.host_says())
        loop.kill()
        off = "drive is off: no effort reaches its motors"
        self.wait_until(host, lambda: off in self.host_says())
        self.assertRegex(self.host_says(), rf"the {off} \(heard \d+\.\d ms ago\); this host enables it only when")
        self.wait_until(host, lambda: self.listed()["state"] == f"its {off}")
        drive = self.listed()["drive"]
        self.assertFalse(drive["on"])
        self.assertGreaterEqual(drive["since_s"], drive["heard_s"])
        self.assertEqual(self.host_says().count(off), 1, self.host_says())

    def test_page_shows_between_sessions_what_the_drive_says(self):
        """Before anything is armed, no loop reads the device: the host says it."""
        host = self.start_host()
        run = self.start_run()

        def device(field, form):
            return self.page.state.inner(client.DEVICE_STATE).number(field, form, -1 if form == "f" else 0)
        homed, sample_age, hosted, host_age = (1, "B"), (5, "f"), (6, "B"), (7, "f")
        self.wait_until(run, lambda: self.page.state is not None and device(*sample_age) >= 0)
        self.assertTrue(device(*hosted) and device(*homed))
        host.send_signal(signal.SIGSTOP)
        self.wait_until(run, lambda: device(*sample_age) > 1 and device(*host_age) > 1)
        host.send_signal(signal.SIGCONT)
        self.wait_until(run, lambda: device(*sample_age) < 1)

    def test_driver_that_hangs_between_sessions_is_the_alarm_of_host_and_page(self):
        hangs = self.folder / "hangs"
        host = self.start_host("hanging", f"read {hangs}")
        run = self.start_run()
        self.wait_until(run, lambda: self.page.state is not None and not self.page.state.number(client.SILENT, "B"))
        hangs.touch()
        self.wait_until(host, lambda: "The robot does not answer. Press the emergency stop" in self.host_says())
        self.wait_until(run, lambda: self.page.state.number(client.SILENT, "B"))
        hangs.unlink()
        self.wait_until(host, lambda: "The robot answers again." in self.host_says())
        self.wait_until(run, lambda: not self.page.state.number(client.SILENT, "B"))

    def test_passport_measured_with_the_driver_is_judged_with_the_delay_behind_a_host(self):
        """The gains are certified for 3 periods: the drive's 2.03 ms. A host of 1 kHz adds up to 2 ms."""
        device = self.config_file("devices", "desktop-3axis", output_delay_ticks="3")
        gains = self.config_file("rendering", "desktop-3axis", k_pm_n_m="105.0")
        rails_commissioned(device, "[0.00195, 0.00205]\ntransport_s = 0.00002")
        run = ("run", "--exercise", "free-grasping", "--patient", CONFIG / "patients/no-arm.toml", "--port", 0,
               "--device", device, "--rendering", gains)
        alone = self.start_app(*run, "--driver", DRIVERS / "rails.so")
        first = alone.stdout.readline()
        if "http" not in first:
            self.fail(first + alone.communicate()[1])
        alone.kill()
        alone.communicate()
        self.start_host("rails", "", ("--device", device), ("--rate-hz", "1000"))
        refused = self.run_app(*run, "--host", NAME)
        self.expect_refused(refused, "--rate-hz", "device commission --host")
        now = re.search(r"the delay is (\S+) ms now \(drive 2.03 ms, transport (\S+) ms\), the passport's 2.05 ms",
                        refused.err)
        self.assertTrue(now, refused.err)
        print(f"figure: transport behind a host of 1 kHz, p99.9 of both ways = {now[2]} ms")
        self.assertGreater(float(now[1]), 3.1, "longer than the periods that are certified")
        self.assertRegex(refused.err, r"not certified|more than 8 periods")

    def test_mismatched_device_is_refused_by_name(self):
        host = ("device-host", "--name", NAME, "--driver", DRIVERS / "rails.so")
        device = self.desktop()[:2]
        run = (*HARDWARE, "--without-passport", *self.desktop())
        self.expect_refused(self.run_app(*run, "--host", NAME), NAME, "does not run",
                            "wholehand device-host")
        self.expect_refused(self.run_app("device-host", "--name", "../a", *host[3:], *device), "../a", "is no name")
        self.expect_refused(self.run_app(*host[:-1], "none.so", *device), "none.so", "cannot open")
        self.expect_refused(self.run_app(*host, "--device", "none.toml"), "none.toml")
        self.expect_refused(self.run_app(*host, "--driver-settings", "watchdog_ms=0", *device), "x", "no watchdog")
        self.expect_refused(self.run_app(*run, "--driver", DRIVERS / "may_wait.so"), "WH_NEVER_WAITS",
                            "wholehand device-host")
        running = self.start_host()
        self.expect_refused(self.run_app(*host, *device), NAME, f"runs already, as process {running.pid}")
        one = self.start_run()
        self.expect_refused(self.run_app(*run, "--host", NAME), NAME, "in use by another loop")
        one.kill()
        one.communicate()
        other = self.desktop(neutral_effort_n="0.5")
        self.expect_refused(self.run_app(*HARDWARE, "--without-passport", *other, "--host", NAME), "z",
                            "another neutral effort")
        for more, words in ((("--driver", "a.so"), ("--driver", "--host")),
                            (("--no-web",), ("--host", "console")),
                            (("--no-rehearsal",), ("--no-rehearsal", "simulated")),
                            (("--uncertified",), ("--uncertified", "simulated"))):
            with self.subTest(more=more):
                arguments = [*run, "--host", NAME, *more]
                if "--no-web" in more:
                    arguments.remove("--port")
                    arguments.remove(0)
                self.expect_refused(self.run_app(*arguments), *words)


if __name__ == "__main__":
    main()
