"""`wholehand certify`: its JSON, exit codes and output, and that its advice passes."""
import json
import math
import re

from app import (BAD_INPUT, CONFIG, DONE, AppTest, expect_known_sentences, main, read_recording,
                 report_data, sentences_of)
from device_app import passport_of

DEVICE, GAINS = CONFIG / "devices/lambda-pride.toml", CONFIG / "rendering/lambda-pride.toml"
HAND = CONFIG / "hands/adult-median-right.toml"
NOT_CERTIFIED = 1
WALL_RATIO = 1.2  # how far a wall may be stiffened during a run (docs/exercises.md)


class Certify(AppTest):
    def certify(self, *arguments, code=DONE):
        result = self.expect(self.run_app("certify", *arguments, "--json", "c.json"), code)
        return result, json.loads((self.folder / "c.json").read_text())

    def gains(self, *changes, name="gains.toml"):
        text = GAINS.read_text()
        for old, new in changes:
            self.assertIn(old, text)
            text = text.replace(old, new)
        return self.write(name, text)

    def test_shipped_files_give_the_documented_json(self):
        for device, axes in (("desktop-3axis", 3), ("lambda-pride", 6), ("wrist-9axis", 9)):
            with self.subTest(device):
                path = CONFIG / f"devices/{device}.toml"
                result, certificate = self.certify("--device", path, "--hand", HAND)
                self.assertIs(certificate["certified"], True)
                self.assertEqual(certificate["rate_hz"], 1000)
                self.assertIsInstance(certificate["binding"], str)
                self.assertEqual(len(certificate["axes"]), axes)
                for axis in certificate["axes"]:
                    self.assertIs(axis["passes"], True)
                    self.assertIn(axis["name"], result.out)
                    self.assertEqual(set(axis["spectral_radius"]), {"free", "rigid", "mass", "spring"})
                    for radius in axis["spectral_radius"].values():
                        self.assertLessEqual(radius, 1 + 1e-7)
                    self.assertLessEqual(axis["damping_required"], axis["damping_available"])
                    self.assertLessEqual(axis["k_pm"], axis["quantisation_limit"])
                    self.assertLessEqual(axis["k_pm"], axis["rigid_contact_limit"])
                    self.assertGreaterEqual(axis["admitted_k_pm"]["1000"], axis["k_pm"])
                *tables, sentence = result.out.splitlines()
                self.assertLessEqual(max(map(len, tables)), 80, "breaks on a terminal: " + result.out)
                self.assertTrue(sentence.startswith("Certified at 1000 Hz with a margin of"), sentence)

    def test_figures_match_closed_forms(self):
        # One of the three axes: b 3 N·s/m, one tick of delay, f_c 0.1 N, Δ 20 µm, T 1 ms.
        _, certificate = self.certify("--device", CONFIG / "devices/desktop-3axis.toml")
        axis = certificate["axes"][0]
        self.assertAlmostEqual(axis["rigid_contact_formula"], 3 / (1e-3 * 1.5))
        self.assertAlmostEqual(axis["viscous_limit"], 2 * 3 / 1e-3)
        self.assertAlmostEqual(axis["coulomb_limit"], 2 * 0.1 / 2e-5)
        self.assertAlmostEqual(axis["quantisation_limit"], 6000)

    def test_rate_affects_the_certificate(self):
        _, certificate = self.certify("--rate-hz", "4000")
        self.assertEqual(certificate["rate_hz"], 4000)
        self.assertAlmostEqual(certificate["axes"][0]["viscous_limit"], 2 * 6 * 4000)
        self.certify("--rate-hz", "250", code=NOT_CERTIFIED)

    def test_too_stiff_gains_are_refused_with_axis_and_a_remedy_that_passes(self):
        hot = self.gains(("k_pm_n_m = 1000.0", "k_pm_n_m = 50000.0"))
        result, certificate = self.certify("--rendering", hot, code=NOT_CERTIFIED)
        self.assertIs(certificate["certified"], False)
        self.assertEqual(certificate["binding"], "x.slew")
        self.assertLessEqual({"slew", "damping", "rigid_contact", "quantisation"},
                             set(certificate["axes"][0]["fails"]))
        self.assertEqual([a["passes"] for a in certificate["axes"]], [False] * 3 + [True] * 3)
        sentence = result.out.splitlines()[-1]
        self.assertTrue(sentence.startswith("NOT certified at 1000 Hz: x: "), sentence)
        nearest = certificate["axes"][0]["nearest"]
        found = re.search(r"k_pm_n_m = (\S+) on x, y, z", sentence)
        self.assertIsNotNone(found, sentence)
        self.assertEqual(float(found[1]), nearest["k_pm"])
        mild = self.gains(("k_pm_n_m = 1000.0", f"k_pm_n_m = {found[1]}"), name="mild.toml")
        self.certify("--rendering", mild)
        still = self.gains(("k_pm_n_m = 1000.0", f"k_pm_n_m = {1.03 * float(found[1])}"), name="still.toml")
        self.certify("--rendering", still, code=NOT_CERTIFIED)

    def test_paper_gains_need_more_damping_than_the_device_has(self):
        # For γ = 0: at least K k_d / 4 k_p, with k_d = 2 √k_p − T k_p and here k_p = 4000 s⁻².
        paper = self.gains(("paper = false", "paper = true"))
        _, certificate = self.certify("--rendering", paper, code=NOT_CERTIFIED)
        axis = certificate["axes"][0]
        self.assertAlmostEqual(axis["k_ps_per_s2"], 4000, delta=1)
        least = 1000 * (2 * math.sqrt(4000) - 4) / (4 * 4000)
        self.assertGreater(axis["damping_required"], least)
        self.assertLess(axis["damping_required"], least + 1.5)  # plus the part for the delay: K T (½ + n)

    def test_run_refuses_what_certify_refuses(self):
        for old, new, criterion in (("k_pm_n_m = 1000.0", "k_pm_n_m = 3000.0", "slew, damping"),
                                    ("paper = false", "paper = true", "damping")):
            with self.subTest(new):
                gains = self.gains((old, new))
                self.certify("--rendering", gains, code=NOT_CERTIFIED)
                run = ["run", "--simulated-clock", "--duration", "0.1", "--exercise", "free-grasping",
                       "--json", "r.json", "--record", "r.h5", "--rendering", gains]
                self.expect_refused(self.run_app(*run), "x.k_pm_n_m", f"not certified ({criterion}",
                                    "largest allowed")
                self.assertFalse((self.folder / "r.json").exists())
                self.expect(self.run_app(*run, "--uncertified"), DONE, "UNCERTIFIED")
                with read_recording(self.folder / "r.h5") as f:
                    self.assertEqual(f["meta"].attrs["uncertified"], 1)
                self.assertIs(json.loads((self.folder / "r.json").read_text())["uncertified"], True)
                self.expect_same_when_run_again(self.folder / "r.h5")
                (self.folder / "r.json").unlink()

    def test_walls_of_an_exercise_are_certified(self):
        _, without = self.certify()
        self.assertIsNone(without["exercise"])
        result, certificate = self.certify("--exercise", "cocktail-bar", "--level", "4", "--charts", "z.html")
        self.assertEqual((certificate["exercise"], certificate["level"]), ("cocktail-bar", 4))
        self.assertIn("the walls of cocktail-bar, level 4", result.out.splitlines()[0])
        fingers, thumb = certificate["axes"][3], certificate["axes"][4]
        # 280 N/m at the tip with a lever of 0.08 m, stiffened by at most WALL_RATIO during a run.
        self.assertAlmostEqual(fingers["wall"]["stiffness"], 280 * 0.08 ** 2 * WALL_RATIO)
        self.assertGreater(fingers["wall"]["damping_required"], fingers["damping_required"])
        self.assertAlmostEqual(fingers["wall"]["margin"],
                               fingers["damping_available"] / fingers["wall"]["damping_required"])
        self.assertIsNone(thumb["wall"])
        page = report_data(self.folder / "z.html")
        self.assertIn("certificate.wall", sentences_of(page["legend"]))
        self.assertIn("certificate.walls", sentences_of(page["notes"]))

    def test_too_stiff_wall_is_refused_by_name(self):
        text = (CONFIG / "exercises/cocktail-bar.toml").read_text().replace(
            "../scenes", str(CONFIG / "scenes")).replace("stiffness_tip_n_m = 280.0", "stiffness_tip_n_m = 600.0")
        hard = self.write("hard.toml", text)
        result, certificate = self.certify("--exercise", hard, "--level", "4", code=NOT_CERTIFIED)
        self.assertEqual(certificate["binding"], "finger_flexion.wall")
        self.assertIn("in the exercise's wall of", result.out.splitlines()[-1])
        self.expect_refused(self.run_app("run", "--simulated-clock", "--duration", "0.1", "--exercise", hard,
                                         "--level", "4"), "finger_flexion", "not certified (wall")

    def test_too_slow_device_is_refused_by_name(self):
        device = self.write("slow.toml", DEVICE.read_text().replace("effort_slew_n_s = 5000.0",
                                                                    "effort_slew_n_s = 2000.0"))
        _, certificate = self.certify("--device", device, "--rendering", GAINS, code=NOT_CERTIFIED)
        self.assertEqual(certificate["binding"], "x.slew")
        self.assertEqual(certificate["axes"][0]["slew_available"], 2000)
        self.assertLess(certificate["axes"][0]["nearest"]["k_pm"], 1000)

    def test_certificate_file_permits_only_its_own_configuration(self):
        self.certify("--exercise", "free-grasping")
        run = ["run", "--simulated-clock", "--duration", "0.1", "--exercise", "free-grasping", "--json", "r.json"]
        self.expect(self.run_app(*run, "--certificate", "c.json"), DONE)
        (self.folder / "r.json").unlink()

        whole = (self.folder / "c.json").read_text()
        self.write("forged.json", whole.replace('"margin": ', '"margin": 1', 1))
        self.write("half.json", whole[:len(whole) // 2])
        self.write("foreign.json", '{"certified": true}')
        self.write("list.json", "[]")
        self.write("text.json", whole.replace('"certified": true', '"certified": "yes"'))
        hot = self.gains(("k_pm_n_m = 1000.0", "k_pm_n_m = 1001.0"))
        for arguments, texts in (
                (["--device", CONFIG / "devices/wrist-9axis.toml"],
                 ["c.json", "is for the device lambda-pride, this run uses wrist-9axis"]),
                (["--rendering", hot], ["other numbers of the rendering lambda-pride"]),
                (["--hand", CONFIG / "hands/woman-p05-right.toml"],
                 ["is for the hand adult-median-right, this run uses woman-p05-right"]),
                (["--rate-hz", "2000"], ["is for 1000 Hz, this run ticks at 2000 Hz"]),
                (["--certificate", "forged.json"], ["forged.json", "was changed after it was written"]),
                (["--certificate", "text.json"], ["text.json", "was changed"]),
                (["--certificate", "half.json"], ["half.json", "damaged"]),
                (["--certificate", "foreign.json"], ["foreign.json", "is not a certificate"]),
                (["--certificate", "list.json"], ["list.json", "is not a certificate"]),
                (["--certificate", "nowhere.json"], ["nowhere.json", "cannot be read"]),
                (["--uncertified"], ["--certificate", "--uncertified"]),
        ):
            with self.subTest(arguments):
                given = arguments if "--certificate" in arguments else ["--certificate", "c.json", *arguments]
                self.expect_refused(self.run_app(*run, *given), *texts)
                self.assertFalse((self.folder / "r.json").exists())
        self.expect_refused(self.run_app("run", "--simulated-clock", "--duration", "0.1", "--certificate", "c.json"),
                            "is for the exercise free-grasping, this run uses cocktail-bar level 1")

    def test_negative_certificate_permits_no_run(self):
        hot = self.gains(("k_pm_n_m = 1000.0", "k_pm_n_m = 3000.0"))
        self.certify("--rendering", hot, code=NOT_CERTIFIED)
        self.expect_refused(self.run_app("run", "--simulated-clock", "--rendering", hot, "--certificate", "c.json"),
                            "c.json", "says that these gains are not certified (binding: x.slew)", lines=1)

    def test_unstable_gains_are_shown_by_spectral_radii(self):
        hot = self.gains(("k_pm_n_m = 1000.0", "k_pm_n_m = 900000.0"))
        _, certificate = self.certify("--rendering", hot, code=NOT_CERTIFIED)
        self.assertGreater(certificate["axes"][0]["spectral_radius"]["rigid"], 1.01)
        self.assertLess(certificate["axes"][0]["margin"], 0.01)

    def test_device_without_damping_cannot_be_helped_by_gains(self):
        text = re.sub(r"damping_n_s_m = 6.0", "damping_n_s_m = 0.0", DEVICE.read_text())
        device = self.write("slippery.toml", text)
        result, certificate = self.certify("--device", device, "--rendering", GAINS, code=NOT_CERTIFIED)
        self.assertIn("no smaller gains pass", result.out)
        self.assertNotIn("nearest", certificate["axes"][0])

    def test_charts_show_working_range_and_limits_of_every_axis(self):
        self.expect(self.run_app("certify", "--charts", "z.html", "--json", "z.json"), DONE)
        page = report_data(self.folder / "z.html")
        expect_known_sentences(self, page)
        self.assertEqual([chart["title"]["with"]["axes"] for chart in page["charts"]],
                         ["x, y, z", "finger_flexion", "thumb_circumduction", "thumb_flexion"])
        self.assertEqual([chart["title"]["with"]["unit"] for chart in page["charts"]], ["N/m"] + 3 * ["N·m/rad"])
        self.assertEqual([line["name"]["sentence"] for line in page["legend"]],
                         [f"certificate.{name}" for name in ("rigid", "passive", "quantisation", "working")])
        axes = {axis["name"]: axis for axis in json.loads((self.folder / "z.json").read_text())["axes"]}
        for name, chart in zip(("x", "finger_flexion", "thumb_circumduction", "thumb_flexion"), page["charts"]):
            rigid, passive, quantisation, working = chart["lines"]
            self.assertEqual(set(working["y"]), {axes[name]["k_pm"]}, name)
            # In the working range of the axis, Φ from 0 to 1, it stays below the limit for any person.
            there = [y for x, y in zip(passive["x"], passive["y"]) if x <= working["x"][-1]]
            self.assertGreater(min(there), working["y"][0], name)
            self.assertTrue(chart["y"]["from"] < working["y"][0] < chart["y"]["to"], name)

    def test_charts_without_built_pages_are_refused_before_anything_is_written(self):
        binary = self.copy_programs(self.folder / "tree/bin")
        (self.folder / "tree/config").symlink_to(CONFIG)
        result = self.run_app("certify", "--charts", "z.html", "--json", "z.json", binary=binary)
        self.expect_refused(result, "web/dist/charts.html", "npm run build", lines=1)
        self.assertFalse((self.folder / "z.json").exists())

    def test_passport_is_certified_and_reported_at_its_worst_corner(self):
        device = CONFIG / "devices/desktop-3axis.toml"
        mine = self.write("mine.toml", device.read_text())
        arguments = ("--device", mine, "--rendering", CONFIG / "rendering/desktop-3axis.toml")
        _, of_file = self.certify(*arguments)
        self.assertIsNone(of_file["corner"])
        good = self.write("good.toml", passport_of(mine))
        result, certificate = self.certify(*arguments, "--passport", good)
        self.assertIn("at the worst corner of the passport", result.out)
        self.assertIn("good.toml", certificate["corner"])
        # The file states 3 N·s/m and the measured encoder: only the masses differ.
        self.assertEqual(certificate["axes"][0]["damping_available"], 3.0)
        self.assertLessEqual(certificate["margin"], of_file["margin"])
        # A third of the stated damping supports less than the 400 N/m.
        weak = self.write("weak.toml", passport_of(mine, damping=(1 / 3, 1.2)))
        result, certificate = self.certify(*arguments, "--passport", weak, code=NOT_CERTIFIED)
        self.assertAlmostEqual(certificate["axes"][0]["damping_available"], 1.0)
        self.assertIn("damping", certificate["axes"][0]["fails"])

    def test_faults_of_all_files_are_reported_at_once(self):
        bad_gains = self.gains(("gamma = 0.3", "gamma = 2.0"), name="bad-gains.toml")
        bad_hand = self.write("bad-hand.toml", HAND.read_text().replace("length_m = 0.1880", "length_m = -1"))
        outputs = ("--json", "c.json", "--charts", "c.html")
        result = self.run_app("certify", "--rendering", bad_gains, "--hand", bad_hand, *outputs)
        self.expect_refused(result, "bad-gains.toml", "bad-hand.toml", lines=2)
        for arguments, text in ((["--device", CONFIG / "devices/wrist-9axis.toml", "--rendering", GAINS], "roll"),
                                (["--rate-hz", "0"], "--rate-hz")):
            self.expect_refused(self.run_app("certify", *arguments, *outputs), text)
        self.assertFalse((self.folder / "c.json").exists() or (self.folder / "c.html").exists())  # no partial file

    def test_unwritable_output_is_refused(self):
        self.write("file", "not a folder")
        result = self.run_app("certify", "--json", "file/c.json")
        self.expect_refused(result, "file")
        self.assertEqual(result.code, BAD_INPUT)


if __name__ == "__main__":
    main()
