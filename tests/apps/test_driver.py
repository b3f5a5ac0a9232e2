"""A real device behind a driver that is compiled outside the tree: C99 and the public header, nothing else."""
import os
import pathlib
import re
import shutil
import signal
import subprocess
import time
import unittest

import client
from app import CONFIG, INTERRUPTED, SOURCE, AppTest, read_recording

DRIVERS = pathlib.Path(os.environ.get("WHOLEHAND_DRIVERS", SOURCE / "build/release/drivers"))
ARM = 1  # protocol/wholehand.fbs, union Order
DEVICE_READ = 1 << 0  # docs/recording.md, bits of `faults`
HARDWARE = ("run", "--exercise", "free-grasping", "--patient", CONFIG / "patients/no-arm.toml", "--port", 0)


class Driver(AppTest):
    def device_file(self):
        """The desktop device, whose watch counts and does not stop: this machine may stall."""
        text = (CONFIG / "devices/desktop-3axis.toml").read_text()
        for key in ("late_in_a_row", "longest_gap_s", "stuck_encoder_s"):
            text = re.sub(rf"^{key} = \S+", f"{key} = 0" if key == "late_in_a_row" else f"{key} = 0.0", text, flags=re.M)
        path = self.folder / "device.toml"
        path.write_text(text)
        return path

    def start(self, driver, *more):
        run = self.start_app(*HARDWARE, "--device", self.device_file(), "--rendering",
                             CONFIG / "rendering/desktop-3axis.toml", "--driver", driver, *more)
        first = run.stdout.readline()
        if ":" not in first:
            self.fail(first + run.communicate()[1])
        self.driver_line = ""
        while "driver" not in self.driver_line and run.poll() is None:
            self.driver_line = run.stdout.readline()
        self.page = client.Page(int(first.split(":")[2].rstrip("/\n")))
        self.page.hold_controls()
        return run

    def arm(self, endings_seen=1):
        accepted, reason = self.page.answer(self.page.say(ARM, ("I", endings_seen)), 90)
        self.assertTrue(accepted, reason)

    def stop(self, run):
        run.send_signal(signal.SIGINT)
        out, err = run.communicate(timeout=60)
        return out + err

    def recordings(self):
        return sorted((self.folder / "out/recordings").glob("*.h5"))

    def test_compiled_outside_the_tree_is_armed_stopped_recorded_and_runs_again(self):
        """Only the header and the example leave the tree."""
        (self.folder / "include/wholehand").mkdir(parents=True)
        shutil.copy(SOURCE / "include/wholehand/device.h", self.folder / "include/wholehand")
        shutil.copy(SOURCE / "examples/driver/rails.c", self.folder)
        subprocess.run(["cc", "-std=c99", "-pedantic", "-Wall", "-Werror", "-O2", "-shared", "-fPIC", "-Iinclude",
                        "rails.c", "-o", "rails.so"], cwd=self.folder, check=True)
        run = self.start("rails.so", "--driver-settings", "watchdog_ms=2000")  # this machine may stall
        time.sleep(0.5)
        self.assertEqual(self.recordings(), [], "nothing is armed before somebody asks")
        self.assertFalse(self.page.answer(self.page.say(client.STEER, ("i", client.PERSON)))[0])
        self.arm()
        time.sleep(1.0)
        self.assertEqual(self.page.answer(self.page.say(client.STEER, ("i", client.PERSON))),
                         (False, "who holds the device moves the hand"))
        self.assertTrue(self.page.answer(self.page.say(client.EMERGENCY_STOP))[0])
        time.sleep(0.5)
        self.arm(endings_seen=3)  # the stop, and the end of the session
        time.sleep(0.3)
        self.assertEqual(run.poll(), None)
        said = self.stop(run)
        self.assertEqual(run.returncode, INTERRUPTED, said)
        self.assertIn("rails (an example), 3 axes", self.driver_line)
        with read_recording(self.recordings()[0]) as first:
            self.assertEqual(first["meta"].attrs["simulated_device"], 0)
            self.assertGreater(len(first["ticks/sent"]), 500)
            self.assertEqual(list(first["ticks/sent"][-1]), [0.0] * 3, "neutral at the end")
        self.expect_same_when_run_again(self.recordings()[0])

    def test_device_that_is_unplugged_while_rendering_ends_at_a_fault_and_nothing_is_lost(self):
        run = self.start(DRIVERS / "spoiled.so", "--driver-settings", "unplug@1500")
        self.arm()
        deadline = time.monotonic() + 60
        while time.monotonic() < deadline and not self.stopped():
            time.sleep(0.1)
        said = self.stop(run)
        self.assertIn("device read failed", said)
        with read_recording(self.recordings()[0]) as recording:
            faults = recording["ticks/faults"][:]
        self.assertGreater(len(faults), 1000)
        self.assertEqual(faults[500] & DEVICE_READ, 0)
        self.assertEqual(faults[-1] & DEVICE_READ, DEVICE_READ)

    def stopped(self):
        """Steering answers "nothing is armed" once the session is over."""
        return self.page.answer(self.page.say(client.STEER, ("i", client.PERSON)))[1] == "nothing is armed"

    def test_what_does_not_fit_is_refused_before_anything_opens(self):
        device = ("--device", CONFIG / "devices/desktop-3axis.toml")
        spoiled = ("--driver", DRIVERS / "spoiled.so")
        for arguments, words in (
                (("--driver", "none.so", *device), ("none.so", "cannot open", "give the path of a driver")),
                (("--driver", DRIVERS / "no_symbol.so", *device), ("no_symbol.so", "wh_plugin_v1")),
                (("--driver", DRIVERS / "other_major.so", *device), ("version 2",)),
                ((*spoiled, "--device-at", "nowhere", *device), ("no device was found at nowhere: nothing answers",)),
                ((*spoiled, "--driver-settings", "deaf", *device), ("x", "no watchdog")),
                (spoiled, ("finger_flexion", "has no such axis", "lambda-pride")),
                ((*spoiled, *device, "--no-rehearsal"), ("--no-rehearsal", "simulated")),
                ((*spoiled, *device, "--uncertified"), ("--uncertified", "simulated")),
                ((*spoiled, *device, "--simulated-clock"), ("--simulated-clock", "simulated")),
                ((*spoiled, *device, "--no-web"), ("--driver", "console"))):
            with self.subTest(arguments=arguments):
                self.expect_refused(self.run_app(*HARDWARE[:-2], *arguments), *words)


if __name__ == "__main__":
    unittest.main()
