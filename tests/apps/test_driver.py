"""A real device behind a driver compiled outside the source tree, with C99 and the public header only."""
import shutil
import signal
import subprocess
import time

import client
from app import BINARY, CONFIG, DONE, HANG_S, INTERRUPTED, LAB, SOURCE, AppTest, main, read_recording
from device_app import DRIVERS, HARDWARE, DeviceTest

DEVICE_READ = 1 << 0  # docs/recording.md, bits of `faults`


class Driver(DeviceTest):
    def start(self, driver, *more):
        return self.start_run(*self.desktop(), "--driver", driver, *more)

    def stop(self, run):
        run.send_signal(signal.SIGINT)
        out, err = run.communicate(timeout=HANG_S)
        return out + err

    def recordings(self):
        return sorted((self.folder / "out/recordings").glob("*.h5"))

    def test_driver_compiled_outside_the_tree_is_armed_stopped_and_recorded(self):
        """Only the header and the example are copied out of the tree."""
        (self.folder / "include/wholehand").mkdir(parents=True)
        shutil.copy(SOURCE / "src/driver_abi/wholehand/device.h", self.folder / "include/wholehand")
        shutil.copy(SOURCE / "examples/driver/rails.c", self.folder)
        subprocess.run(["cc", "-std=c99", "-pedantic", "-Wall", "-Werror", "-O2", "-shared", "-fPIC", "-Iinclude",
                        "rails.c", "-o", "rails.so"], cwd=self.folder, check=True)
        run = self.start("rails.so", "--driver-settings", "watchdog_ms=2000")  # tolerates stalls of this machine
        time.sleep(0.5)
        self.assertEqual(self.recordings(), [], "nothing is armed before somebody asks")
        self.assertFalse(self.page.answer(self.page.say(client.STEER, ("i", client.PERSON)))[0])
        self.arm()
        self.wait_for_ticks(run, 700)
        device = self.page.state.inner(client.DEVICE_STATE)
        self.assertEqual([device.number(i, "B") for i in range(4)], [1, 1, 0, 0])  # enabled, homed; no temperature
        self.assertTrue(0.0 <= device.number(5, "f") < 2.0, "the age of the sample")
        self.assertEqual(self.page.answer(self.page.say(client.STEER, ("i", client.PERSON))),
                         (False, "the person at the device moves the hand"))
        self.assertTrue(self.page.answer(self.page.say(client.EMERGENCY_STOP))[0])
        time.sleep(0.5)
        self.arm(endings_seen=3)  # the stop and the end of the session are endings
        time.sleep(0.3)
        self.assertEqual(run.poll(), None)
        said = self.stop(run)
        self.assertEqual(run.returncode, INTERRUPTED, said)
        self.assertIn("rails (an example), 3 axes", self.driver_line)
        with read_recording(self.recordings()[0]) as first:
            self.assertEqual(first["meta"].attrs["simulated_device"], 0)
            self.assertEqual(first["meta"].attrs["passport"], b"without")
            self.assertGreater(len(first["ticks/sent"]), 500)
            self.assertEqual(list(first["ticks/sent"][-1]), [0.0] * 3, "neutral at the end")
        self.expect_same_when_run_again(self.recordings()[0])

    def test_device_unplugged_while_rendering_faults_and_loses_no_tick(self):
        run = self.start(DRIVERS / "faulty.so", "--driver-settings", "unplug@1500")
        self.arm()
        deadline = time.monotonic() + HANG_S
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
        """The answer to Steer is "nothing is armed" once the session is over."""
        return self.page.answer(self.page.say(client.STEER, ("i", client.PERSON)))[1] == "nothing is armed"

    def test_mismatched_device_is_refused_before_it_is_opened(self):
        device = ("--device", CONFIG / "devices/desktop-3axis.toml")
        faulty = ("--driver", DRIVERS / "faulty.so")
        for arguments, words in (
                (("--driver", "none.so", *device), ("none.so", "cannot open", "give the path of a driver")),
                (("--driver", DRIVERS / "no_symbol.so", *device), ("no_symbol.so", "wh_plugin_v1")),
                (("--driver", DRIVERS / "other_major.so", *device), ("version 2",)),
                ((*faulty, "--device-at", "nowhere", *device), ("no device was found at nowhere: nothing answers",)),
                ((*faulty, "--driver-settings", "deaf", *device), ("x", "no watchdog")),
                (faulty, ("finger_flexion", "has no such axis", "lambda-pride")),
                ((*faulty, *device, "--no-rehearsal"), ("--no-rehearsal", "simulated")),
                ((*faulty, *device, "--uncertified"), ("--uncertified", "simulated")),
                ((*faulty, *device, "--simulated-clock"), ("--simulated-clock", "simulated")),
                ((*faulty, *device, "--engine", "bullet-paper"),
                 ("--engine = bullet-paper: is not for real devices" if LAB else "is not built into this program",)),
                ((*faulty, *device, "--no-web"), ("--driver", "console"))):
            with self.subTest(arguments=arguments):
                self.expect_refused(self.run_app(*HARDWARE[:-2], *arguments, "--without-passport"), *words)


class Passport(AppTest):
    """A device without a passport is refused; `--without-passport` is shown clearly and recorded."""

    def test_device_without_a_passport_is_refused_with_the_remedy(self):
        run = (*HARDWARE, "--device", CONFIG / "devices/desktop-3axis.toml", "--driver")
        self.expect_refused(self.run_app(*run, DRIVERS / "rails.so"), "desktop-3axis.rails-0001.passport.toml",
                            "device rails-0001 has no passport", "wholehand device commission")
        self.expect_refused(self.run_app(*run, DRIVERS / "faulty.so", "--driver-settings", "anonymous"),
                            "no serial number", "wh_plugin.identify")

    def test_simulated_device_refuses_passport_options(self):
        self.expect_refused(self.run_app("run", "--without-passport", "--simulated-clock"), "--without-passport",
                            "real device")


class Commission(AppTest):
    COMMISSION = ("device", "commission", "--operator", "A", "--device", CONFIG / "devices/desktop-3axis.toml")

    def test_missing_answer_gives_no_passport(self):
        self.expect(self.run_app(*self.COMMISSION, "--driver", DRIVERS / "rails.so"), 1, "Step 1 of 12: identify",
                    "rails-0001", "Not finished")
        self.assertEqual(self.names_in(self.folder), [])

    def test_commissioning_without_a_terminal_moves_nothing(self):
        done = subprocess.run([BINARY, *map(str, self.COMMISSION), "--driver", DRIVERS / "rails.so"], text=True,
                              input="yes\nyes\nquit\n", capture_output=True, timeout=HANG_S)
        self.assertEqual(done.returncode, 1, done.stdout + done.stderr)
        self.assertIn("Step 2 of 12: home", done.stdout)
        self.assertIn("no key can be held", done.stderr)

    def test_mismatched_device_is_refused(self):
        self.expect_refused(self.run_app(*self.COMMISSION), "--driver", "--host", "--simulated")
        self.expect_refused(self.run_app(*self.COMMISSION, "--simulated", "--driver", DRIVERS / "rails.so"), "--simulated")
        self.expect_refused(self.run_app(*self.COMMISSION, "--driver", "none.so"), "none.so", "cannot open")
        self.expect_refused(self.run_app(*self.COMMISSION, "--driver", DRIVERS / "rails.so", "--daily"),
                            "rails-0001.passport.toml")


if __name__ == "__main__":
    main()
