"""`wholehand validate`, and `run` with files that it refuses: one message gives file, place and remedy."""
import shutil

from app import BAD_INPUT, CONFIG, DONE, MOTION, SOURCE, AppTest, main, read_recording
from device_app import passport_of, sealed

DEVICE, GAINS = CONFIG / "devices/lambda-pride.toml", CONFIG / "rendering/lambda-pride.toml"
HAND, PATIENT = CONFIG / "hands/adult-median-right.toml", CONFIG / "patients/relaxed-adult.toml"
SCENE = CONFIG / "scenes/four-shapes.toml"


class Shipped(AppTest):
    def test_all_shipped_files_pass_in_one_call(self):
        # A prescription is for one device; the others' ranges need not hold it.
        prescriptions = sorted((CONFIG / "prescriptions").glob("*.toml"))
        self.expect(self.run_app("validate", CONFIG / "devices/lambda-pride.toml", *prescriptions), DONE, "ok  prescription")
        files = sorted({*CONFIG.rglob("*.toml")} - {*prescriptions}) + sorted((SOURCE / "data").rglob("*.csv"))
        self.assertGreater(len(files), 30)
        result = self.expect(self.run_app("validate", *files), DONE)
        self.assertEqual(result.err, "")
        said = [line for line in result.out.splitlines() if line.startswith("ok ")]
        self.assertEqual(len(said), len(files), result)

    def test_copies_in_another_folder_pass_alone(self):
        for file in (SCENE, HAND, DEVICE, GAINS, PATIENT, MOTION):
            copy = shutil.copy(file, self.folder / ("copy" + file.suffix))
            self.expect(self.run_app("validate", copy), DONE, "ok ")


class Passports(AppTest):
    """Files written by commissioning, alone and with their device file."""

    def test_passport_and_check_pass(self):
        mine = self.write("mine.toml", (CONFIG / "devices/desktop-3axis.toml").read_text())
        passport = self.write("mine.S-1.passport.toml", passport_of(mine))
        check = self.write("mine.S-1.check.toml", sealed('kind = "device-check"\nversion = 1\ndone_at = "2026-11-21T09:30:00-08:00"\n'
                                                         'operator = "A"\npassport_sha256 = "0"\n\n'))
        self.expect(self.run_app("validate", passport, check), DONE, "ok  passport", "serial number S-1", "ok  device-check")
        self.expect(self.run_app("validate", mine, passport), DONE, "ok  passport")

    def test_mistakes_in_a_passport_are_named(self):
        mine = self.write("mine.toml", (CONFIG / "devices/desktop-3axis.toml").read_text())
        other = self.write("other.toml", mine.read_text() + "# other\n")
        for text, files, says in ((passport_of(mine) + "#\n", (), "changed after it was written"),
                                  (passport_of(other), (mine,), "was changed since"),
                                  (passport_of(mine, day="2020-01-01"), (mine,), "has expired")):
            with self.subTest(says=says):
                self.expect_refused(self.run_app("validate", self.write("p.toml", text), *files), "p.toml", says)


class Guessed(AppTest):
    """`validate` states what a single file is checked against, and what to do if that is the wrong counterpart."""

    def test_gains_alone_report_the_assumed_device_and_hand(self):
        gains = shutil.copy(GAINS, self.folder / "my-gains.toml")
        self.expect(self.run_app("validate", gains), DONE,
                    "on the device lambda-pride with the hand adult-median-right")

    def test_mismatched_axes_ask_for_the_device(self):
        gains = shutil.copy(CONFIG / "rendering/wrist-9axis.toml", self.folder / "my-gains.toml")
        self.expect_refused(self.run_app("validate", gains), "roll", "lambda-pride.toml",
                            "name its device file beside it")
        device = CONFIG / "devices/wrist-9axis.toml"
        self.expect(self.run_app("validate", gains, device), DONE)
        result = self.expect_refused(self.run_app("validate", gains, DEVICE), "roll")
        self.assertNotIn("beside it", result.err)  # the device was given


    def test_motion_alone_reports_that_no_device_was_checked(self):
        millimetres = self.write("mm.csv", "time_s,x_m\n" + "".join(f"{.01 * i:.2f},{.2 * i:.1f}\n" for i in range(100)))
        self.expect(self.run_app("validate", millimetres), DONE, "ok  motion",
                    "not held against a device: name its device file beside it")
        self.expect_refused(self.run_app("validate", millimetres, DEVICE), "mm.csv", "x_m")
        result = self.expect(self.run_app("validate", MOTION, DEVICE), DONE, "ok  motion")
        self.assertNotIn("not held", result.out)

    def test_extension_of_a_motion_is_accepted_in_any_case(self):
        for name in ("MOTION.CSV", "Motion.Csv"):
            self.expect(self.run_app("validate", self.write(name, MOTION.read_text())), DONE, "ok  motion", name)

    def test_driver_settings_refer_to_the_command_that_checks_them(self):
        settings = sorted((SOURCE / "drivers").rglob("*.toml"))
        self.assertGreaterEqual(len(settings), 2)
        pair = self.write("pair.toml", 'kind = "composite"\nversion = 1\nlongest_skew_s = 0.005\n')
        for file in (*settings, pair):
            with self.subTest(file.name):
                driver = "composite" if file == pair else file.parent.name
                command = f"device inspect --driver {driver} --driver-settings {file}"
                result = self.expect_refused(self.run_app("validate", file), f'{file}:', "is the settings of a driver",
                                             "wholehand " + command, lines=1)
                self.assertNotIn("is unknown", result.err)
                # `run` reads them before it opens the device, and finds a shipped driver by its name.
                wrong = self.write("wrong.toml", file.read_text().replace("version = 1", "version = 1\nwidht = 1"))
                checked = self.run_app(*command.split()[:-1], wrong)
                self.expect(checked, BAD_INPUT)
                self.assertIn("widht", checked.out + checked.err)


class Mistakes(AppTest):
    def changed(self, name, base, old, new):
        text = base.read_text()
        self.assertIn(old, text)
        return self.write(name, text.replace(old, new, 1))

    def scene_with(self, body, assets=None):
        folder = self.folder / f"scene-{len(list(self.folder.iterdir()))}"
        folder.mkdir()
        for name, content in (assets or {}).items():
            (folder / name).write_text(content)
        path = folder / "scene.toml"
        path.write_text('kind = "scene"\nversion = 1\nname = "s"\ngravity_m_s2 = [0.0, 0.0, 0.0]\n'
                        f'[[bodies]]\nname = "b"\nposition_m = [0.2, 0.0, 0.0]\n{body}\n')
        return path

    def test_non_convex_mesh_is_reported(self):
        # A notched bar: an L of two boxes has an inward edge.
        profile = [(0, 0), (4, 0), (4, 1), (1, 1), (1, 4), (0, 4)]
        bent = "".join(f"v {x * .02} {y * .02} {z}\n" for z in (0, .02) for x, y in profile)
        bent += "f 1 4 3 2\nf 1 6 5 4\nf 7 8 9 10\nf 7 10 11 12\n"
        bent += "".join(f"f {i} {i % 6 + 1} {i % 6 + 7} {i + 6}\n" for i in range(1, 7))
        path = self.scene_with('shape = "mesh"\nfile = "m.obj"\nmass_kg = 0.1\n', {"m.obj": bent})
        result = self.run_app("validate", path)
        self.assertEqual((result.code, result.err), (0, ""), result)
        # The hull covers 11.5 squares, the bar 7.
        for text in (f"{path}:9: bodies[b].file: the mesh ", "m.obj is not convex", "64.3 % larger in volume",
                     "; the hand cannot reach into a hollow"):
            self.assertIn(text, result.out)

    def test_all_mistakes_of_all_files_are_reported_in_one_call(self):
        device = self.changed("device.toml", DEVICE, "mass_kg = 0.8", "mass_kg = nan")
        device.write_text(device.read_text().replace("encoder_step_m", "encoder_stp_m", 1))
        scene = self.changed("scene.toml", SCENE, "friction = 0.8 ", "friction = 3.0 ")
        motion = self.write("motion.csv", "time_s,x_m\n0,0\n0.01,abc\n0.02,\n")
        result = self.expect_refused(self.run_app("validate", device, HAND, scene, motion, "none.toml"))
        lines = result.err.splitlines()
        for name, count in (("device.toml", 2), ("scene.toml", 1), ("motion.csv", 2),
                            ("none.toml", 1)):
            self.assertEqual(sum(name + ":" in line for line in lines), count, result)
        self.assertEqual(len(lines), 6, result)
        self.assertIn("adult-median-right", result.out)  # valid files are listed as valid


class RunRefuses(AppTest):
    def expect_run_refused(self, *arguments, texts=(), lines=None):
        before = self.names_in(self.folder)
        result = self.expect_refused(self.run_app("run", "--simulated-clock", *arguments), *texts,
                                     lines=lines)
        self.assertNotIn("Done", result.out)
        self.assertEqual(self.names_in(self.folder), before)  # no partial file and no folder left
        return result

    def test_bad_file_of_every_option_is_refused(self):
        for option in ("--scene", "--hand", "--device", "--rendering", "--patient", "--motion"):
            with self.subTest(option):
                name = "bad" + (".csv" if option == "--motion" else ".toml")
                self.write(name, "nonsense\n")
                self.expect_run_refused(option, name, texts=[name])
                self.expect_run_refused(option, "missing-" + name, texts=["missing-" + name])

    def test_file_of_another_kind_is_refused(self):
        self.expect_run_refused("--scene", HAND, texts=["adult-median-right.toml", "scene"], lines=1)
        self.expect_run_refused("--hand", SCENE, texts=["four-shapes.toml", "hand"], lines=1)
        self.expect_run_refused("--motion", SCENE, texts=["four-shapes.toml"], lines=1)
        self.expect_run_refused("--device", HAND, texts=["adult-median-right.toml", "device"], lines=1)

    def test_device_without_gains_asks_for_them(self):
        (self.folder / "elsewhere").mkdir()
        device = shutil.copy(DEVICE, self.folder / "elsewhere/mine.toml")
        self.expect_run_refused("--device", device, texts=["elsewhere/mine.toml", "give --rendering"],
                                lines=1)
        self.expect_refused(self.run_app("certify", "--device", device), "give --rendering", lines=1)
        self.expect_run_refused("--device", "nowhere.toml", texts=["nowhere.toml"], lines=1)
        # All errors of the device itself come first.
        text = DEVICE.read_text().replace("mass_kg", "mas_kg")
        faulty = self.write("elsewhere/faulty.toml", text)
        self.expect_run_refused("--device", faulty, texts=["did you mean mass_kg"],
                                lines=text.count("\nmas_kg"))

    def test_gains_of_another_device_are_refused(self):
        self.expect_run_refused("--rendering", CONFIG / "rendering/wrist-9axis.toml", texts=["roll"])

    def test_body_inside_the_hand_is_refused(self):
        # The recording gives the hand's position when it is armed; its palm is 5 cm in front of the wrist.
        with read_recording(self.record(duration=0.1)) as f:
            x, y, z = f["meta"].attrs["armed_position"][:3]
        text = SCENE.read_text().replace("position_m = [0.055, 0.11, 0.0]",
                                         f"position_m = [{x + 0.05}, {y}, {z}]")
        self.write("inside.toml", text)
        self.expect_run_refused("--scene", "inside.toml", texts=["inside.toml", "cylinder", "hand"],
                                lines=1)
        # All checks come before the device is armed, and no file is made until then.
        self.write("file", "")
        self.expect_run_refused("--scene", "inside.toml", "--record", "file/run.h5",
                                texts=["file/run.h5", "not a folder"], lines=1)
        self.expect_run_refused("--scene", "inside.toml", "--record", "new/run.h5",
                                texts=["inside.toml", "cylinder", "hand"], lines=1)


if __name__ == "__main__":
    main()
