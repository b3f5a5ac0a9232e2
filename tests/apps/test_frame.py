"""The program with the reference firmware of the frame: found by name, armed, stopped, killed."""
import signal
import subprocess
import time

from app import ALWAYS, BINARY, CONFIG, HANG_S, INTERRUPTED, main
from device_app import HARDWARE, DeviceTest

FIRMWARE = BINARY.parent / "frame_firmware"


class Frame(DeviceTest):
    terminal = True

    def start_firmware(self, where, silence_ms):
        """Starts the firmware and returns its locator. Its output has lines of phase, ms since the last command, effort,
        gap."""
        self.lines = self.folder / "firmware.log"
        with self.lines.open("w") as out:
            firmware = subprocess.Popen([FIRMWARE, where, f"silence_ms={silence_ms}"], stdout=out)
        self.addCleanup(firmware.wait)
        self.addCleanup(firmware.terminate)
        self.wait_until(firmware, lambda: self.lines.read_text().startswith("at "))
        return self.lines.read_text().split()[1]

    def phases(self):
        return [line.split() for line in self.lines.read_text().splitlines()[1:]]

    def phase(self):
        return self.phases()[-1][0] if self.phases() else "off"

    def start_run(self, at):
        return super().start_run(*self.desktop(), "--driver", "frame", "--device-at", at)

    def test_stop_over_udp_and_serial_leaves_the_firmware_neutral_and_off(self):
        for where in ("udp:0", "serial"):
            run = self.start_run(self.start_firmware(where, 2000))  # this machine may stall
            self.assertEqual(self.phase(), "off", "nothing is enabled before somebody asks")
            self.arm()
            self.wait_until(run, lambda: self.phase() == "rendering", self.phases)
            time.sleep(0.5)
            self.assertEqual(self.phase(), "rendering", where)
            run.send_signal(signal.SIGINT)
            said = "".join(run.communicate(timeout=HANG_S))
            self.assertEqual(run.returncode, INTERRUPTED, where + said)
            self.assertEqual([p[0] for p in self.phases()][-1], "off", self.phases())
            self.assertEqual(float(self.phases()[-1][2]), 0.0)
            self.assertNotIn("latched", [p[0] for p in self.phases()], "its watchdog had nothing to do")

    def test_killed_program_leaves_the_firmware_latched_at_neutral(self):
        run = self.start_run(self.start_firmware("shm:test-app-%d" % time.monotonic_ns(), 2000))  # this machine may stall
        self.arm()
        self.wait_until(run, lambda: self.phase() == "rendering", self.phases)
        time.sleep(0.3)
        run.send_signal(signal.SIGKILL)
        run.communicate()
        until = time.monotonic() + HANG_S
        while self.phase() != "latched" and time.monotonic() < until:
            time.sleep(0.01)
        phase, silent_ms, effort, _ = self.phases()[-1]
        self.assertEqual(phase, "latched", self.phases())
        self.assertEqual(float(effort), 0.0, ALWAYS)
        self.assertGreater(float(silent_ms), 2000.0)

    def test_missing_device_is_refused_by_name(self):
        device = ("--device", CONFIG / "devices/desktop-3axis.toml")
        self.expect_refused(self.run_app(*HARDWARE, *device, "--driver", "fram"), "fram", "give one of", "composite", "frame",
                            "rails")
        for at, words in (("tcp:1", ("tcp:1", "names no carrier", "shm:NAME")),
                          ("serial:/dev/none", ("/dev/none cannot be opened",)),
                          ("udp:127.0.0.1:9", ("nobody answers",))):
            with self.subTest(at=at):
                self.expect_refused(self.run_app(*HARDWARE, *device, "--driver", "frame", "--device-at", at), *words)


if __name__ == "__main__":
    main()
