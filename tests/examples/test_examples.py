"""Every example prints what its first lines promise."""
import csv
import os
import pathlib
import re
import signal
import subprocess
import sys

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parents[1] / "apps"))
import client  # noqa: E402
from app import DONE, HANG_S, SOURCE, PacedTest, main, read_recording  # noqa: E402

EXAMPLES = pathlib.Path(os.environ["WHOLEHAND_EXAMPLES"])
DRIVERS = pathlib.Path(os.environ.get("WHOLEHAND_DRIVERS", SOURCE / "build/release/drivers"))
MOST_LINES = 80


class Examples(PacedTest):
    def example(self, name, *arguments):
        return self.expect(self.run_app(*arguments, binary=EXAMPLES / name), DONE)

    def test_every_example_is_short_and_tested(self):
        for file in sorted((SOURCE / "examples").glob("*.cpp")):
            self.assertLess(len(file.read_text().splitlines()), MOST_LINES, file.name)
            self.assertIn(f'"{file.stem}"', pathlib.Path(__file__).read_text())

    def test_first_touch_prints_the_spring_force_between_device_and_hand(self):
        rows = [[float(word) for word in line.split()]
                for line in self.example("01_first_touch").out.splitlines()[1:]]
        self.assertEqual(len(rows), 21)
        _, device_mm, hand_mm, felt_n, contacts = rows[-1]
        self.assertGreater(contacts, 0)
        self.assertLess(device_mm, hand_mm - 5)
        # Eq. (3) at rest with K_pm = 1 N/mm; the file's columns have two decimals in mm.
        self.assertAlmostEqual(felt_n, 1.0 * (hand_mm - device_mm), delta=0.011)
        # The patient, with 0.3 N/mm towards -60 mm, pushes equally, except for 0.2 N of dry friction.
        self.assertAlmostEqual(felt_n, 0.3 * (device_mm + 60), delta=0.21)
        # The box had no effect before it was touched, and the hand is not inside it.
        before = [row for row in rows if row[4] == 0]
        self.assertGreater(len(before), 5)
        self.assertLess(max(row[3] for row in before), 0.5)
        self.assertLess(max(row[2] for row in rows[-5:]) - min(row[2] for row in rows[-5:]), 0.05)

    def test_rig_alone_ticks_without_a_recorder(self):
        said = self.example("08_rig_alone").out
        self.assertRegex(said, r"certified; rehearsed: .*allowed")
        self.assertIn("6 axes", said)
        self.assertIn("faults 0 ", said)
        linked = subprocess.run(["ldd", EXAMPLES / "08_rig_alone"], text=True, capture_output=True, check=True).stdout
        self.assertIn("libBullet", linked)
        self.assertNotRegex(linked, r"hdf5|boost|sqlite|sodium")

    def test_own_device_gets_the_opposite_of_its_pull(self):
        said = self.example("02_own_device").out
        self.assertIn("pulled with 3.000 N", said)
        back_n = float(re.search(r"gives back (\S+) N", said)[1])
        self.assertAlmostEqual(back_n, 3.0, delta=0.003)

    def test_bodies_of_a_game_press_with_a_bounded_force(self):
        said = self.example("07_bodies_of_a_game").out
        appeared, solid = (float(re.search(rf"(\S+) s  slot 0 {event}", said)[1])
                           for event in ("appeared", "solid"))
        self.assertGreater(solid, appeared + 0.01)  # first it overlapped the palm
        pressed_n = [float(n) for n in re.findall(r"presses with (\S+) N", said)]
        self.assertEqual(max(pressed_n[:6]), 0.0)  # the body is away from the hand
        self.assertGreater(pressed_n[-1], 0.5)
        self.assertLess(pressed_n[-1], 5.0 * 1.1)

    def test_run_and_record_stores_every_tick(self):
        said = self.example("05_run_and_record", "rails.h5", "1").out
        ticks, recorded = (int(n) for n in re.search(r"(\d+) ticks, (\d+) recorded", said).groups())
        self.assertGreater(ticks, 500)  # a busy machine skips some of the 1,000 ticks
        self.assertEqual(recorded, ticks)
        with read_recording(self.folder / "rails.h5") as file:
            self.assertEqual(len(file["ticks/tick"]), ticks)
            self.assertEqual(file["meta"].attrs["simulated_device"], 0)
            self.assertEqual(file["meta"].attrs["models_changed"], 0)
            self.assertFalse(file["ticks/sent"][-1].any())  # the session ends at neutral
        self.assertFalse((self.folder / "rails.h5.black-box").exists())
        self.expect_same_when_run_again(self.folder / "rails.h5")

    def test_serve_a_driver_can_be_armed_and_stopped_at_a_page(self):
        run = subprocess.Popen([EXAMPLES / "06_serve_a_driver", DRIVERS / "rails.so", "watchdog_ms=2000"],
                               cwd=self.folder, text=True, stdout=subprocess.PIPE, stderr=subprocess.STDOUT)
        self.addCleanup(run.communicate)
        self.addCleanup(run.kill)
        page = client.Page(int(re.search(r":(\d+)/console", run.stdout.readline())[1]))
        page.hold_controls()
        accepted, reason = page.answer(page.say(client.ARM, ("I", 1), ("I", page.basis())), 90)  # the only ending so far
        self.assertTrue(accepted, reason)
        self.assertTrue(page.answer(page.say(client.EMERGENCY_STOP))[0])
        run.send_signal(signal.SIGINT)
        said = run.communicate(timeout=HANG_S)[0]
        self.assertIn("1 sessions", said)
        self.assertIn(run.returncode, (0, 1), said)  # a stall of the machine stops a real device

    def test_read_a_recording_prints_what_h5py_reads(self):
        recording = self.record(duration=0.3)
        rows = list(csv.reader(self.example("03_read_a_recording", recording).out.splitlines()))
        self.assertEqual(rows[0], ["time_s", "x_n", "y_n", "z_n", "finger_flexion_nm",
                                   "thumb_circumduction_nm", "thumb_flexion_nm"])
        with read_recording(recording) as file:
            time_s, sent = file["ticks/time_s"][:], file["ticks/sent"][:]
        self.assertEqual(len(rows) - 1, len(sent))
        for row, time, efforts in zip(rows[1:], time_s, sent):
            self.assertAlmostEqual(float(row[0]), time, delta=5e-5)
            for text, effort in zip(row[1:], efforts):
                self.assertAlmostEqual(float(text), effort, delta=1e-5 * abs(effort) + 1e-12)

    def test_read_a_recording_without_a_file_makes_and_removes_one(self):
        said = self.run_app(binary=EXAMPLES / "03_read_a_recording", env={"TMPDIR": str(self.folder)})
        self.expect(said, DONE)
        # Half a second, plus the ramp to neutral of at most 100 ms.
        self.assertGreater(len(said.out.splitlines()), 500)
        self.assertLessEqual(len(said.out.splitlines()), 1 + 500 + 101)
        self.assertEqual(self.names_in(self.folder), [])

    def test_change_the_gains_is_certified_up_to_its_stated_limit(self):
        largest = {}
        rate = None
        for line in self.example("04_change_the_gains").out.splitlines():
            if line.endswith(" Hz") and "N/m" not in line:
                rate = float(line.split()[0])
                largest[rate] = 0.0
            elif line.endswith(" certified") and "refused" not in line:
                largest[rate] = max(largest[rate], float(line.split()[0]))
            elif "refused" in line:
                allowed = float(re.search(r"largest allowed k_pm_n_m: (\S+) N/m", line)[1])
                self.assertGreater(float(line.split()[0]), allowed)
                self.assertGreaterEqual(allowed, largest[rate])
        self.assertGreaterEqual(largest[1000.0], 1000.0)  # the shipped gain
        self.assertGreater(largest[2000.0], largest[1000.0])


if __name__ == "__main__":
    main()
