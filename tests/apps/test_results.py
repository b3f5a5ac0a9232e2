"""The results of an exercise: in the summary, in --json, in the recording and in the report."""
import json

from app import BAD_INPUT, DONE, FREE_RUN, AppTest, main, read_recording, report_data


class Results(AppTest):
    def test_results_of_an_exercise_other_than_the_bar_are_reported_everywhere(self):
        # The virtual patient has held all three levels after 15 s.
        result = self.run_app("run", "--exercise", "squeeze-to-level", "--simulated-clock", "--duration", 25,
                              "--record", "s.h5", "--json", "s.json", "--report", "page")
        self.expect(result, DONE, "squeeze-to-level, level 1", "Levels done 3; Score ", "faults   none")
        reported = json.loads((self.folder / "s.json").read_text())["exercise"]
        self.assertEqual((reported["name"], reported["level"]), ("squeeze-to-level", 1))
        self.assertEqual(list(reported["results"]), ["bands_done", "score"])
        # The same results in three places; the recording's last values are the source.
        recording = read_recording(self.folder / "s.h5")
        self.addCleanup(recording.close)
        names = [text.decode() for text in recording["meta"].attrs["value_names"]]
        last = dict(zip(names, recording["ticks/exercise_values"][-1]))
        self.assertEqual(reported["results"], {name: last[name] for name in reported["results"]})
        self.assertEqual(reported["results"]["bands_done"], 3)
        self.assertGreater(reported["results"]["score"], 50)
        shown = report_data(self.folder / "page/index.html")["about"]["result"]
        self.assertEqual([(r["label"], r["value"], r["decimals"]) for r in shown],
                         [("Levels done", 3, 0), ("Score", reported["results"]["score"], 0)])

    def test_results_of_the_bar_have_units(self):
        result = self.run_app("run", "--simulated-clock", "--duration", 1.5, "--json", "b.json")
        self.expect(result, DONE, "result   Poured 0 ml; Spilt 0 ml; Score 0")
        reported = json.loads((self.folder / "b.json").read_text())["exercise"]
        self.assertEqual(reported["results"], {"poured_total_l": 0.0, "spilt_l": 0.0, "score": 0.0})

    def test_limits_are_made_of_own_movement_and_hold_in_the_next_run(self):
        self.expect(self.run_app("run", "--exercise", "own-range", "--simulated-clock", "--duration", 60, "--record", "own.h5"),
                    DONE, "Fingers open to", "faults   none")
        result = self.run_app("prescribe", "own.h5", "--name", "P-014", "--out", "limits.toml")
        self.expect(result, DONE, "limits", "run --prescription limits.toml")
        text = (self.folder / "limits.toml").read_text()
        self.assertIn('side = "right"', text)
        # The fingers were measured in both directions, x and y not yet.
        self.assertIn('axis = "finger_flexion"', text)
        self.assertNotIn('axis = "y"', text)
        self.expect(self.run_app("validate", "limits.toml"), DONE, "ok")
        self.expect(self.run_app("run", "--exercise", "squeeze-to-level", "--prescription", "limits.toml", "--simulated-clock",
                                 "--duration", 1), DONE, "allowed  P-014: ")
        self.expect(self.run_app("run", "--exercise", "own-range", "--prescription", "limits.toml", "--simulated-clock",
                                 "--duration", 1), DONE, "measured without the limits of limits.toml")
        self.expect(self.run_app("prescribe", "own.h5", "--name", "Anna Keller"), BAD_INPUT, "not a person's name")
        self.expect(self.run_app("run", "--simulated-clock", "--duration", 1, "--record", "bar.h5"), DONE)
        self.expect(self.run_app("prescribe", "bar.h5"), BAD_INPUT, "has no own movement", "--exercise own-range")
        self.expect(self.run_app("prescribe", "none.h5"), BAD_INPUT, "none.h5")

    def test_answers_of_a_comparison_give_one_threshold_everywhere(self):
        result = self.run_app("run", "--exercise", "tell-apart-firmer", "--simulated-clock", "--duration", 300,
                              "--record", "t.h5", "--json", "t.json")
        self.expect(result, DONE, "tell-apart-firmer, level 1", "result   Answers ", "threshold", "faults   none")
        results = json.loads((self.folder / "t.json").read_text())["exercise"]["results"]
        measured = json.loads(self.expect(self.run_app("measures", "t.h5", "--answers", "t.csv"), DONE).out)
        compared = measured["compared"]
        self.assertEqual((compared["version"], compared["answers"]), (1, results["answers"]))
        self.assertGreaterEqual(compared["answers"], 30)
        self.assertEqual(compared["said_by"], {"squeeze": results["answers"], "player": 0, "therapist": 0, "earlier": 0})
        # A virtual patient measures nobody.
        self.assertFalse(compared["persons"])
        self.assertNotIn("threshold_percent", [r["name"] for r in measured["results"]])
        # The answers as CSV are fitted alike; x is recorded as float.
        self.expect(self.run_app("experiment", "thresholds", "--fit", "t.csv", "--json", "fit.json"), DONE)
        fitted = json.loads((self.folder / "fit.json").read_text())
        self.assertAlmostEqual(fitted["sigma"], compared["sigma"], delta=1e-4)
        if compared["enough"]:
            self.assertAlmostEqual(results["threshold_percent"], 100 * (compared["ratio"] - 1), delta=0.01)

    def test_few_answers_say_what_is_missing(self):
        result = self.run_app("run", "--exercise", "tell-apart-later", "--simulated-clock", "--duration", 20, "--json", "f.json")
        self.expect(result, DONE, "not enough for a threshold", "at least 30 are needed")
        self.assertGreater(json.loads((self.folder / "f.json").read_text())["exercise"]["results"]["answers_missing"], 25)

    def test_run_without_an_exercise_has_no_results(self):
        result = self.run_app(*FREE_RUN, "--simulated-clock", "--duration", 0.5, "--json", "m.json")
        self.expect(result, DONE)
        self.assertNotIn("result ", result.out)
        self.assertNotIn("exercise", json.loads((self.folder / "m.json").read_text()))


if __name__ == "__main__":
    main()
