"""`--engine`: every engine runs scenes and exercises, is named in what is written, and is run again."""
import json

from app import CONFIG, DONE, FREE_RUN, AppTest, main, read_recording

ENGINES = ("bullet", "mujoco", "bullet-newton", "bullet-paper", "bullet-paper-gears")
# θ = θ₀ + G q_s: what a step may leave of it before correction. Rounding; the paper's own way lets
# contacts bend single joints, and puts them back.
COUPLING_RAD = {"bullet": 1e-9, "mujoco": 1e-9, "bullet-newton": 1e-9, "bullet-paper": 0.1,
                "bullet-paper-gears": 0.1}


class EveryEngine(AppTest):
    def run_with(self, engine, *arguments):
        self.expect(self.run_app(*arguments, "--engine", engine, "--simulated-clock", "--json", "run.json",
                                 "--record", "run.h5"), DONE)
        with open(self.folder / "run.json", encoding="utf-8") as file:
            summary = json.load(file)
        self.assertEqual(summary["engine"], engine)
        self.assertFalse(summary["faulted"])
        with read_recording(self.folder / "run.h5") as file:
            self.assertEqual(file["meta"].attrs["engine"].decode(), engine)
        return summary

    def test_a_motion_touches_the_table_and_is_run_again_bit_by_bit_slow(self):
        for engine in ENGINES:
            with self.subTest(engine):
                summary = self.run_with(engine, *FREE_RUN, "--scene", CONFIG / "scenes/table.toml")
                self.assertGreater(summary["contacts_max"], 0)
                self.assertLess(summary["max_coupling_error_rad"], COUPLING_RAD[engine])
                self.expect_same_when_run_again("run.h5")

    def test_the_bar_is_played_and_run_again_bit_by_bit_slow(self):
        for engine in ENGINES:
            with self.subTest(engine):
                self.run_with(engine, "run", "--exercise", "cocktail-bar", "--no-web", "--duration", "8")
                self.expect_same_when_run_again("run.h5")

    def test_one_grasp_is_held_slow(self):
        for engine in ("bullet", "mujoco"):  # bullet-paper slips: docs/engines.md
            with self.subTest(engine):
                self.expect(self.run_app("experiment", "grasping", "--engine", engine, "--only", "pinch sphere",
                                         "--jittered", "0", "--out", "grasp", "--json", "grasp.json"), DONE)
                with open(self.folder / "grasp.json", encoding="utf-8") as file:
                    results = json.load(file)
                self.assertEqual(results["engine"], engine)
                self.assertTrue(results["trials"])
                for trial in results["trials"]:
                    self.assertFalse(trial["dropped"], trial)


if __name__ == "__main__":
    main()
