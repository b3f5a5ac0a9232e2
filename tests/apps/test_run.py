"""`wholehand run`: its output files, its endings, and the data that survive a kill or a full disk."""
import json
import os
import pty
import re
import signal
import subprocess
import time
import unittest

import numpy

from app import (BINARY, CONFIG, DONE, FAULT, FREE_RUN, FULL, HANG_S, INTERRUPTED, STOP_REQUESTED, AppTest, PacedTest,
                 limit_file_size, loop_sleeps, main, read_recording)

AXES = ["x", "y", "z", "finger_flexion", "thumb_circumduction", "thumb_flexion"]


class InRealTime(PacedTest):
    def test_scene_is_rehearsed_first(self):
        result = self.run_app(*FREE_RUN, "--duration", "0.3", "--json", "run.json")
        self.expect(result, DONE, "rehearsed", "safety   armed at 0.000 s", "disarmed at 0.3")
        rehearsal = json.loads((self.folder / "run.json").read_text())["rehearsal"]
        self.assertGreater(rehearsal["ticks"], 1000)
        self.assertGreater(rehearsal["bodies_touched"], 0)
        self.assertEqual(rehearsal["limit_us"], 500.0)  # half of 1 ms
        self.assertLessEqual(rehearsal["cpu_us"]["p999"], 500.0)
        result = self.run_app(*FREE_RUN, "--duration", "0.1", "--no-rehearsal", "--json", "run.json")
        self.expect(result, DONE)
        self.assertNotIn("rehearsed", result.out)
        self.assertNotIn("rehearsal", json.loads((self.folder / "run.json").read_text()))

    def test_run_lasts_its_duration(self):
        began = time.monotonic()
        self.record(duration=2.0, simulated=False)
        self.assertGreater(time.monotonic() - began, 2.0)


class WhatItWrites(AppTest):
    def test_run_writes_its_three_files_and_no_other(self):
        result = self.expect(
            self.run_app(*FREE_RUN, "--simulated-clock", "--record", "a/run.h5", "--json", "b/run.json",
                         "--report", "c"), DONE, "Done after", "a/run.h5", "c/index.html")
        self.assertEqual(result.err, "")
        self.assertEqual(self.names_in(self.folder),
                         ["a", "a/run.h5", "b", "b/run.json", "c", "c/index.html"])
        summary = json.loads((self.folder / "b/run.json").read_text())
        self.check_summary(summary)
        self.check_recording(summary)
        self.check_report()

    def test_run_says_what_a_prescription_allows_and_what_the_device_does_not_bear(self):
        # Half of what desktop-3axis bears is less than 300 N/m.
        prescription = self.write("p.toml", 'kind = "prescription"\nversion = 1\nname = "p"\nside = "right"\n'
                                  '[[limits]]\naxis = "x"\nwithin_m = [-0.04, 0.03]\n'
                                  '[corridor]\nradius_m = 0.03\nstiffness_n_m = 300.0\n')
        result = self.run_app("run", "--scene", CONFIG / "scenes/four-shapes.toml", "--device",
                              CONFIG / "devices/desktop-3axis.toml", "--prescription", prescription, "--simulated-clock",
                              "--duration", "0.5", "--json", "run.json")
        self.expect(result, DONE, "allowed  p: x -40 to 30 mm (", " of 300: the device bears no more")

    def check_summary(self, summary):
        for key in ("ticks", "missed_deadlines", "faults", "contacts_max"):
            self.assertIs(type(summary[key]), int, key)
        self.assertGreater(summary["ticks"], 1000)
        self.assertEqual(summary["missed_deadlines"], 0)  # no deadlines on the simulated clock
        self.assertEqual(summary["faults"], 0)
        self.assertIs(summary["uncertified"], False)
        self.assertEqual([t["to"] for t in summary["safety"]], ["armed", "rendering", "disarmed"])
        self.assertEqual(summary["safety"][2]["reasons"], ["stop requested"])  # the duration is over
        self.assertNotIn("rehearsal", summary)  # no rehearsal without real time
        self.assertGreater(summary["contacts_max"], 0)  # the motion touches the shapes
        self.assertEqual(list(summary["max_effort"]), AXES)
        for effort in summary["max_effort"].values():
            self.assertIs(type(effort), float)
            self.assertGreater(effort, 0.0)
        for key in ("p50", "p99", "p999", "max"):
            self.assertGreater(summary["cpu_us"][key], 0.0)

    def check_recording(self, summary):
        with read_recording(self.folder / "a/run.h5") as f:
            # The code of docs/recording.md.
            time_s, sent = f["ticks/time_s"][:], f["ticks/sent"][:]
            names, units = ([text.decode() for text in f["ticks/sent"].attrs[key]] for key in ("labels", "units"))
            self.assertEqual(list(names), AXES)
            self.assertEqual(list(units), ["N", "N", "N", "N·m", "N·m", "N·m"])
            self.assertEqual(len(time_s), summary["ticks"])
            self.assertAlmostEqual(time_s[-1] - time_s[0], (summary["ticks"] - 1) * 1e-3, places=9)
            for axis, name in enumerate(AXES):  # both outputs report the same values
                self.assertEqual(abs(sent[:, axis]).max(), numpy.float32(summary["max_effort"][name]))
            self.assertEqual(f["ticks/contact_count"][:].max(), summary["contacts_max"])
            work_j = (sent[:-1] * numpy.diff(f["ticks/q_m"][:], axis=0)).sum()  # of the device, by the recording
            self.assertAlmostEqual(work_j, summary["work_j"], delta=1e-3 * max(1.0, abs(work_j)))
            embedded = {group.attrs["name"].decode() for group in f["meta/files"].values()}
            for file in ("config/scenes/four-shapes.toml", "config/devices/lambda-pride.toml",
                         "config/rendering/lambda-pride.toml", "config/patients/relaxed-adult.toml",
                         "config/hands/adult-median-right.toml",
                         "data/human-motion/reach-grasp-00.csv"):
                self.assertIn(file, embedded)

    def check_report(self):
        page = (self.folder / "c/index.html").read_text()
        self.assertIn('"page":"report"', page)  # test_report.py checks its contents

    def test_run_without_output_options_writes_all_three_into_a_new_folder(self):
        self.expect(self.run_app(*FREE_RUN, "--simulated-clock", "--duration", "0.3"), DONE)
        (run,) = (self.folder / "out").iterdir()
        self.assertRegex(run.name, r"^run-\d{8}-\d{6}")
        self.assertEqual(self.names_in(run),
                         ["recording.h5", "report", "report/index.html", "run.json"])
        self.assertEqual(os.listdir(self.folder), ["out"])

    def test_two_runs_at_once_keep_their_outputs_apart(self):
        runs = [self.start_app(*FREE_RUN, "--simulated-clock", "--duration", "0.3") for _ in range(2)]
        for run in runs:
            said, complained = run.communicate(timeout=HANG_S)
            self.assertEqual(run.returncode, DONE, said + complained)
        self.assertEqual(len(os.listdir(self.folder / "out")), 2)

    def test_scene_too_slow_for_the_rate_is_refused_before_any_effort(self):
        # The physics of 7 bodies needs more than half of 62.5 µs.
        result = self.run_app("run", "--scene", CONFIG / "scenes/table.toml", "--duration", "0.3",
                              "--rate-hz", "16000")
        self.expect_refused(result, "rehearsal", "31 µs", "most of it is physics_step")
        self.assertEqual(os.listdir(self.folder), [])

    def test_only_requested_files_are_written(self):
        self.expect(self.run_app(*FREE_RUN, "--simulated-clock", "--duration", "0.3", "--json", "run.json"),
                    DONE)
        self.assertEqual(self.names_in(self.folder), ["run.json"])

    def test_shortest_run_at_the_slowest_rate_ends(self):
        slow = self.write("slow.toml", (CONFIG / "rendering/lambda-pride.toml").read_text().replace(
            "k_pm_nm_rad = 4.0", "k_pm_nm_rad = 4.0\narmature_kg_m2 = 0.0008").replace(
            "k_pm_nm_rad = 1.5", "k_pm_nm_rad = 1.5\narmature_kg_m2 = 0.0003"))
        result = self.run_app(*FREE_RUN, "--simulated-clock", "--duration", "0.001", "--rate-hz", "100",
                              "--rendering", slow, "--uncertified", "--json", "run.json")
        self.expect(result, DONE, "Done after")


class HowItEnds(AppTest):
    def interrupted(self, how):
        run = self.start_app(*FREE_RUN, "--no-rehearsal", "--duration", "600", "--record", "run.h5", "--json", "run.json",
                             "--report", "report")
        self.wait_until_it_renders(run)
        time.sleep(2.0)
        run.send_signal(how)
        said, complained = run.communicate(timeout=HANG_S)
        self.assertEqual(run.returncode, INTERRUPTED, said + complained)
        self.assertIn("Interrupted after", said)
        self.assertIn("run.h5", said)
        self.assertTrue(json.loads((self.folder / "run.json").read_text())["interrupted"])
        self.assertTrue((self.folder / "report/index.html").exists())
        with read_recording(self.folder / "run.h5") as f:
            self.assertGreater(len(f["ticks/tick"]), 100)
            sent, authority, faults = (f["ticks/" + n][:] for n in ("sent", "authority", "faults"))
            elapsed = f["ticks/elapsed_periods"][:]
        # The device's neutral effort is zero on every axis (its file); the ramp ends within 100 ms.
        self.assertEqual(authority[-1], 0.0)
        self.assertEqual(abs(sent[-1]).max(), 0.0)
        stopping = (faults & STOP_REQUESTED) != 0
        self.assertGreater(stopping.sum(), 1)
        self.assertLessEqual(elapsed[stopping].sum(), 101 + elapsed[stopping].max())
        self.expect_same_when_run_again("run.h5")

    def test_ctrl_c_ramps_closes_the_recording_and_prints_the_summary(self):
        self.interrupted(signal.SIGINT)

    def test_sigterm_ends_like_ctrl_c(self):
        self.interrupted(signal.SIGTERM)

    def test_closed_terminal_ends_like_ctrl_c(self):
        self.interrupted(signal.SIGHUP)

    def test_hang_up_under_nohup_is_ignored(self):
        run = self.start_app(*FREE_RUN, "--no-rehearsal", "--duration", "2.5", "--json", "run.json",
                             preexec_fn=lambda: signal.signal(signal.SIGHUP, signal.SIG_IGN))
        self.wait_until_it_renders(run)
        self.expect_ended_by(run, signal.SIGHUP, DONE)
        self.assertFalse(json.loads((self.folder / "run.json").read_text())["interrupted"])

    def test_ctrl_z_ends_the_run_instead_of_freezing_the_loop(self):
        run = self.start_app(*FREE_RUN, "--no-rehearsal", "--duration", "600", "--json", "run.json")
        self.wait_until_it_renders(run)
        self.expect_ended_by(run, signal.SIGTSTP)

    def test_ctrl_c_on_the_simulated_clock_ends_the_run(self):
        run = self.start_app(*FREE_RUN, "--duration", "3600", "--simulated-clock", "--json", "run.json")
        self.wait_until_it_catches(run, signal.SIGINT)
        time.sleep(0.5)
        self.expect_ended_by(run, signal.SIGINT)

    def test_fault_stops_the_run_with_its_name_and_a_ramp(self):
        # A second axis drives the thumb's base like the first, so the reduced inertia is singular. The certificate
        # refuses such a hand; without the certificate, the fault of the tick must stop it.
        def with_twin(name, file, begin):
            text = (CONFIG / file).read_text()
            at = text.index(begin)
            axis = text[at:text.index("[[axes]]", at + 5)]
            return self.write(name, text + "\n" + axis.replace("thumb_circumduction", "twin"))

        device = with_twin("device.toml", "devices/lambda-pride.toml", "[[axes]]  # 0 to 90 degrees")
        device.write_text(device.read_text().replace("[0.0, 1.5707963267948966]", "[0.0, 0.78]"))
        gains = with_twin("gains.toml", "rendering/lambda-pride.toml",
                          '[[axes]]\nname = "thumb_circumduction"')
        hand = self.write("hand.toml", (CONFIG / "hands/adult-median-right.toml").read_text().replace(
            "[synergy.thumb_flexion]",
            "[synergy.twin]\nthumb_circumduction = 1.0\n\n[synergy.thumb_flexion]").replace(
            "thumb_circumduction_rad", "twin_rad = 0.0\nthumb_circumduction_rad"))
        files = ["--device", device, "--rendering", gains, "--hand", hand]
        self.expect_refused(self.run_app(*FREE_RUN, "--simulated-clock", *files), "singular")
        result = self.expect(
            self.run_app(*FREE_RUN, "--simulated-clock", "--duration", "5", *files, "--uncertified",
                         "--record", "run.h5", "--json", "run.json", "--report", "report"),
            FAULT, "Stopped by a fault", "singular reduced inertia", "UNCERTIFIED")
        self.assertNotIn("Done", result.out)
        summary = json.loads((self.folder / "run.json").read_text())
        self.assertGreater(summary["faults"], 0)
        self.assertIs(summary["faulted"], True)
        self.assertEqual([t["to"] for t in summary["safety"]], ["faulted"])
        self.assertEqual(summary["safety"][0]["reasons"], ["singular reduced inertia"])
        self.assertEqual(summary["safety"][0]["tick"], 0)
        with read_recording(self.folder / "run.h5") as f:
            self.assertLessEqual(f["ticks/time_s"][-1], 0.1)  # stopped at once; the ramp included
            self.assertEqual(f["ticks/authority"][-1], 0.0)
            self.assertTrue((abs(f["ticks/sent"][-1]) == 0.0).all())
        self.expect_same_when_run_again("run.h5")

    def test_limited_effort_is_reported_with_its_axis(self):
        # 0.05 N are less than a reaching hand feels of the simulated one; only x is limited.
        text = (CONFIG / "devices/lambda-pride.toml").read_text()
        weak = text.replace("effort_limit_n = 20.0", "effort_limit_n = 0.05", 1)
        self.assertNotEqual(weak, text)
        result = self.expect(self.run_app(*FREE_RUN, "--simulated-clock", "--duration", "3", "--uncertified",
                                          "--device", self.write("weak.toml", weak),
                                          "--rendering", CONFIG / "rendering/lambda-pride.toml",
                                          "--json", "run.json"), DONE, "effort limited in ", " (x)")
        summary = json.loads((self.folder / "run.json").read_text())
        limited = summary["fault_ticks"]["effort limited"]
        self.assertGreater(limited, 0)
        self.assertEqual(summary["fault_axes"]["effort limited"], {"x": limited})
        self.assertIn(f"effort limited in {limited} ticks (x)", result.out)

    def test_status_line_is_redrawn_on_a_terminal(self):
        ours, theirs = pty.openpty()
        run = subprocess.Popen([BINARY, *FREE_RUN, "--no-rehearsal", "--duration", "1.5", "--json", "run.json"],
                               cwd=self.folder, stdin=subprocess.DEVNULL, stdout=theirs,
                               stderr=theirs)
        self.addCleanup(run.kill)
        os.close(theirs)
        said = b""
        while True:
            try:
                said += os.read(ours, 4096)
            except OSError:  # the program has closed the terminal
                break
        os.close(ours)
        self.assertEqual(run.wait(timeout=HANG_S), DONE, said)
        # One line, redrawn in place several times a second, with seven values.
        drawn = re.findall(r"\r\x1b\[K *([\d.]+) s +([\d.]+) Hz  tick (\d+)/(\d+)/(\d+) µs  "
                           r"missed (\d+)  (\d+) contacts?  largest force \S", said.decode())
        self.assertGreaterEqual(len(drawn), 3, said)
        times_s = [float(line[0]) for line in drawn]
        self.assertEqual(times_s, sorted(times_s))
        self.assertIn("Done after", said.decode())

    def test_run_continues_if_nobody_reads_its_status(self):
        # As in `wholehand run | head -1`: the reader is gone, and the run and its recording continue or end cleanly.
        run = self.start_app(*FREE_RUN, "--simulated-clock", "--record", "run.h5")
        run.stdout.readline()
        run.stdout.close()
        run.wait(timeout=HANG_S)
        run.stdout = None
        self.expect_same_when_run_again("run.h5")


class WhatSurvives(PacedTest):
    def lost_in_a_kill(self, path, after_s):
        """Number of ticks of a run that its recording lacks after kill -9."""
        run = self.start_app(*FREE_RUN, "--no-rehearsal", "--duration", "60", "--record", path)
        while not path.exists():
            time.sleep(0.01)
            self.assertIsNone(run.poll())
        time.sleep(after_s)
        ran = loop_sleeps(run.pid)
        run.kill()
        run.wait()
        with read_recording(path) as f:
            kept = len(f["ticks/tick"])
        self.expect_same_when_run_again(path)
        self.expect(self.run_app("report", path, "--out", "report"), DONE)
        return ran - kept

    def test_kill_at_any_moment_costs_less_than_a_second_and_a_half(self):
        trials = 20 if FULL else 3
        for trial in range(trials):
            after_s = self.random.uniform(1.5, 4.0)
            with self.subTest(trial=trial, after_s=after_s):
                self.assertLess(self.lost_in_a_kill(self.folder / f"killed-{trial}.h5", after_s), 1500)

    def check_run_over_a_full_disk(self, path, **how):
        result = self.expect(self.run_app(*FREE_RUN, "--simulated-clock", "--duration", "20", "--record",
                                          path, "--json", self.folder / "run.json", **how),
                             DONE, "Done after 20")
        self.assertRegex(result.out, r"dropped +\d+ records: the disk was full")
        summary = json.loads((self.folder / "run.json").read_text())
        with read_recording(path) as f:
            kept = len(f["ticks/tick"])
        self.assertGreater(kept, 100)
        self.assertEqual(kept + summary["records_dropped"], summary["ticks"])
        self.assertRegex(result.out, rf"dropped +{summary['records_dropped']} records")
        # The file is valid: it is replayed, drawn and simulated again up to the time when the disk was full.
        self.expect(self.run_app("replay", "--speed", "1000", path), DONE)
        self.expect(self.run_app("report", path, "--out", "report"), DONE)
        self.expect_same_when_run_again(path)

    def test_limit_of_file_size_acts_like_a_full_disk(self):
        self.check_run_over_a_full_disk(self.folder / "run.h5", preexec_fn=limit_file_size(4_500_000))

    @unittest.skipUnless(os.geteuid() == 0, "only root can make a small disk")
    def test_full_small_disk_keeps_the_recording_readable(self):
        disk = self.folder / "disk"
        disk.mkdir()
        mounted = subprocess.run(["mount", "-t", "tmpfs", "-o", "size=4500k", "tmpfs", str(disk)],
                                 capture_output=True, text=True, check=False)
        if mounted.returncode != 0:
            self.skipTest("mount is not allowed here: " + mounted.stderr.strip())
        self.addCleanup(subprocess.run, ["umount", str(disk)], check=True)
        self.check_run_over_a_full_disk(disk / "run.h5")

    def test_disk_without_room_for_the_metadata_is_refused(self):
        result = self.run_app(*FREE_RUN, "--simulated-clock", "--record", "run.h5",
                              preexec_fn=limit_file_size(2_000))
        self.expect_refused(result, "run.h5", lines=1)
        self.assertEqual(self.names_in(self.folder), [])


if __name__ == "__main__":
    main()
