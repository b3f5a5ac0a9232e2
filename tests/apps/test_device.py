"""`wholehand device list | inspect | conform`."""
import json
import os
import pathlib
import re
import signal

from app import CONFIG, DONE, SOURCE, AppTest, main

DRIVERS = pathlib.Path(os.environ.get("WHOLEHAND_DRIVERS", SOURCE / "build/release/drivers"))
DESKTOP = CONFIG / "devices/desktop-3axis.toml"
NAME = f"test-device-{os.getpid()}"
NOT_FIT = 1


class Device(AppTest):
    def written(self, name="out.json"):
        return json.loads((self.folder / name).read_text())

    def state_of_host(self):
        self.run_app("device", "list", "--json", "out.json")
        return next(h for h in self.written()["hosts"] if h["name"] == NAME)["state"]

    def test_list_shows_drivers_and_a_host_with_its_state(self):
        for leftover in (NAME, NAME + ".lock"):
            self.addCleanup(pathlib.Path("/dev/shm", "wholehand-" + leftover).unlink, missing_ok=True)
        # The host's two cycles count as delay, too (docs/device-host.md).
        device = self.write("slow.toml", re.sub(r"^output_delay_ticks = \S+", "output_delay_ticks = 2",
                                                DESKTOP.read_text(), flags=re.M))
        host = self.start_app("device-host", "--name", NAME, "--driver", DRIVERS / "rails.so", "--device", device)
        while "holds" not in (line := host.stdout.readline()):
            self.assertNotEqual(line, "", "the host ended")
        self.wait_until(host, lambda: self.state_of_host() == "idle")
        result = self.run_app("device", "list", "--json", "out.json")
        self.expect(result, DONE, "rails (an example)", "has no wh_plugin_v1()", NAME)
        listed = next(h for h in self.written()["hosts"] if h["name"] == NAME)
        self.assertEqual((listed["driver"], listed["axes"], listed["pid"], listed["lives"], listed["in_use"]),
                         ("rails (an example)", 3, host.pid, True, False))
        drivers = {pathlib.Path(d["file"]).stem: d for d in self.written()["drivers"]}
        self.assertTrue(drivers["rails"]["never_waits"])
        self.assertFalse(drivers["pushed"]["never_waits"])
        self.assertIn("version 2", drivers["other_major"]["problem"])
        host.send_signal(signal.SIGKILL)
        host.wait()
        self.assertEqual(self.state_of_host(), "gone")

    def test_inspect_shows_the_axes_and_refuses_what_run_refuses(self):
        rails = ("device", "inspect", "--driver", DRIVERS / "rails.so")
        self.expect(self.run_app(*rails, "--device", DESKTOP, "--json", "out.json"), DONE, "fits", "homed")
        found = self.written()
        # The axes of examples/driver/rails.c.
        self.assertEqual([(a["name"], a["lower"], a["upper"]) for a in found["axes"]],
                         [("x", -0.06, 0.06), ("y", -0.09, 0.09), ("z", -0.07, 0.07)])
        self.assertEqual({(a["effort_limit"], a["silence_s"], a["temperature_c"]) for a in found["axes"]},
                         {(8.0, 0.02, None)})
        self.assertNotIn("enabled", found["status"])
        self.expect_refused(self.run_app("device", "inspect", "--driver", DRIVERS / "faulty.so", "--driver-settings",
                                         "deaf", "--device", DESKTOP), "no watchdog")
        self.expect_refused(self.run_app(*rails, "--device", CONFIG / "devices/lambda-pride.toml"), "finger_flexion",
                            "has no such axis")
        self.expect_refused(self.run_app(*rails, "--device-at", "there"), "only to be found")
        self.expect_refused(self.run_app("device", "inspect", "--driver", "none.so"), "none.so", "cannot open")

    def test_conform_passes_a_good_driver_and_enables_nothing_unless_allowed(self):
        conform = ("device", "conform", "--driver", DRIVERS / "rails.so", "--json", "out.json")
        self.expect(self.run_app(*conform), DONE, "0 failed", "--allow-effort, with nobody attached")
        looked = self.written()
        self.expect(self.run_app(*conform, "--allow-effort", "--allow-beyond-limit"), DONE, "0 failed")
        moved = self.written()
        self.assertGreaterEqual(len(moved["checks"]), 60)
        self.assertGreater(moved["passed"], looked["passed"])
        self.assertEqual({c["outcome"] for c in looked["checks"] if c["id"].startswith("commands.")}, {"not run"})

    def test_conform_reports_the_broken_rule_and_a_remedy(self):
        result = self.run_app("device", "conform", "--driver", DRIVERS / "broken.so", "--driver-settings", "millimetres",
                              "--json", "out.json", "--only", "description")
        self.expect(result, NOT_FIT, "FAIL description.travel_plausible", "200 m of travel", "use m, N, s")
        self.assertEqual([c["id"] for c in self.written()["checks"] if c["outcome"] == "failed"],
                         ["description.travel_plausible", "description.resolution_plausible"][:self.written()["failed"]])

    def test_conform_survives_a_driver_that_crashes(self):
        result = self.run_app("device", "conform", "--driver", DRIVERS / "broken.so", "--driver-settings", "crashes")
        self.expect(result, NOT_FIT, "the driver ended the process", "ok   description.count")

    def test_conform_refuses_bad_arguments(self):
        rails = ("device", "conform", "--driver", DRIVERS / "rails.so")
        self.expect_refused(self.run_app("device", "conform", "--driver", "none.so"), "none.so", "is no file")
        self.expect_refused(self.run_app(*rails, "--only", "nonsense"), "nonsense", "no check")
        self.expect_refused(self.run_app(*rails, "--allow-beyond-limit"), "--allow-effort")


if __name__ == "__main__":
    main()
