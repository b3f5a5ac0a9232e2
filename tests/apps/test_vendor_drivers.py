"""The drivers of Force Dimension and moteus in the program, with fake devices."""
import os
import pathlib
import re
import signal
import subprocess
import time

from app import ALWAYS, BINARY, CONFIG, HANG_S, INTERRUPTED, SOURCE, main
from device_app import DRIVERS, DeviceTest

BUILT = DRIVERS.parent
NAME = f"test-vendor-{os.getpid()}"
HAND = ("finger_flexion", "thumb_circumduction", "thumb_flexion")
MODE = re.compile(r"drive (\d) mode (\d+) torque (\S+) silent (\S+) gap (\S+)")


class VendorDrivers(DeviceTest):
    terminal = True

    def start_hand(self):
        """Starts three fake moteus drives behind a pseudo terminal (tests/drivers/moteus/fake_hand.cpp)."""
        self.log = self.folder / "hand.log"
        with open(self.log, "w") as log:
            hand = subprocess.Popen([BUILT / "fake_hand"], stdin=subprocess.PIPE, stdout=log)
        self.addCleanup(hand.wait)
        self.addCleanup(hand.stdin.close)
        self.wait_until(hand, lambda: "\n" in self.log.read_text())
        return self.log.read_text().splitlines()[0]

    def modes(self):
        """The last line of each drive: {id: (mode, torque before [N.m], silent [ms], longest gap of the drive [ms])}."""
        return {int(m[1]): (int(m[2]), *map(float, m.groups()[2:])) for m in MODE.finditer(self.log.read_text())}

    def moteus(self, port):
        return ("--device", self.config_file("devices", "lambda-pride", HAND), "--rendering",
                self.config_file("rendering", "lambda-pride", HAND), "--driver", DRIVERS / "moteus.so",
                "--device-at", f"fdcanusb:{port}", "--driver-settings", SOURCE / "drivers/moteus/hand.toml")

    def test_killed_program_is_released_by_the_moteus_drives(self):
        run = self.start_run(*self.moteus(self.start_hand()))
        self.assertIn("moteus drives, 3 axes", self.driver_line)
        self.assertEqual(self.modes(), {}, ALWAYS + "nothing moves before somebody arms")
        self.arm()
        self.wait_until(run, lambda: len(self.modes()) == 3)
        self.assertEqual({mode for mode, *_ in self.modes().values()}, {10})
        self.wait_until_it_renders(run)
        run.send_signal(signal.SIGKILL)
        run.wait()
        until = time.monotonic() + HANG_S
        while time.monotonic() < until and {mode for mode, *_ in self.modes().values()} != {11}:
            time.sleep(0.05)
        for drive, (mode, _, silent, gap) in self.modes().items():
            self.assertEqual(mode, 11, f"{ALWAYS}drive {drive}")
            # 20 ms by the drive's clock, plus the time that this machine delayed the drive.
            self.assertLessEqual(silent, 21.0 + 2 * gap)
            print(f"figure: drive {drive} lets go after {silent:.1f} ms (longest gap of the drive {gap:.1f} ms)")

    def test_end_of_the_program_stops_the_moteus_drives(self):
        run = self.start_run(*self.moteus(self.start_hand()))
        self.arm()
        self.wait_until(run, lambda: len(self.modes()) == 3)
        run.send_signal(signal.SIGINT)
        out, err = run.communicate(timeout=HANG_S)
        # Drives that this machine delayed answer late, which stops the program first.
        late = "samples delayed" in out + err or "enable lost" in out + err
        if not late or max(gap for *_, gap in self.modes().values()) < 1.0:
            self.assertEqual(run.returncode, INTERRUPTED, out + err)
        ends = {0, 11} if late else {0}
        until = time.monotonic() + HANG_S
        while time.monotonic() < until and not {mode for mode, *_ in self.modes().values()} <= ends:
            time.sleep(0.05)
        self.assertLessEqual({mode for mode, *_ in self.modes().values()}, ends)

    def test_force_dimension_device_is_held_by_a_host_and_armed(self):
        for leftover in (NAME, NAME + ".lock"):
            self.addCleanup(pathlib.Path("/dev/shm", "wholehand-" + leftover).unlink, missing_ok=True)
        device = self.config_file("devices", "desktop-3axis")
        # A device with a short delay: with the host's two cycles it stays within the stated period.
        quick = (SOURCE / "drivers/force_dimension/lambda-7.toml").read_text().replace("delay_s = 0.001 ", "delay_s = 0.0004 ")
        settings = ("--driver-settings", self.write("lambda-7.toml", quick))
        driver = ("--driver", DRIVERS / "force_dimension.so")
        sdk = dict(os.environ, FORCEDIM_SDK=str(BUILT / "fake_sdk/current"))
        rendering = ("--rendering", self.config_file("rendering", "desktop-3axis"))
        exercise = ("--exercise", "free-grasping", "--patient", CONFIG / "patients/no-arm.toml")
        self.expect_refused(self.run_app("run", *exercise, "--device", device, *rendering, *driver, *settings, env=sdk),
                            "a host can")
        log = open(self.folder / "host.log", "w")
        self.addCleanup(log.close)
        host = subprocess.Popen([BINARY, "device-host", "--name", NAME, "--device", device, *driver, *settings],
                                cwd=self.folder, env=sdk, stdin=subprocess.DEVNULL, stdout=log, stderr=log)
        self.addCleanup(host.wait)
        self.addCleanup(host.kill)
        said = lambda: (self.folder / "host.log").read_text()
        self.wait_until(host, lambda: f"{NAME}: holds" in said())
        self.assertIn("fake.7, SDK 3.17.1", said())
        run = self.start_run("--host", NAME, "--device", device, *rendering)
        self.arm()
        time.sleep(0.5)
        # If this machine delayed the loop by 20 ms, the host released it.
        kept_waiting = lambda: "the loop sent no new command" in said()
        if not kept_waiting():
            self.assertEqual(run.poll(), None)
        run.send_signal(signal.SIGINT)
        out, err = run.communicate(timeout=HANG_S)
        if not kept_waiting():
            self.assertEqual(run.returncode, INTERRUPTED, out + err + said())
        self.assertIn("enabled by process", said())


if __name__ == "__main__":
    main()
