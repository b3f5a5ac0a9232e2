"""Figures of sessions in which not only the person moved the hand, compared with a recount by recount.py."""
from app import FULL, SEED, main, read_recording, report_data
from recount import MOTION, VIRTUAL_PATIENT, Compared

CASES = 200 if FULL else 10


class Figures(Compared):
    def test_figures_of_random_hand_overs_match_the_recount(self):
        # Played by the virtual patient: two drinks of two steps each, and three bands of force.
        bases = [self.record("bar.h5", "--exercise", "cocktail-bar", "--level", 2, "--seed", str(SEED), duration=60),
                 self.record("squeeze.h5", "--exercise", "squeeze-to-level", "--seed", str(SEED), duration=40)]
        kinds, lived = self.compare_drawn(bases, CASES)
        print(f"figure: {CASES} sessions recounted, parts of {len(kinds)} of 9 kinds; active in {lived[0]}, helped in "
              f"{lived[1]}, led in {lived[2]}, with reaches in {lived[3]}")
        self.assertGreaterEqual(len(kinds), 6)  # the random cases cover the kinds of parts
        self.assertGreater(min(lived), 0)

    def test_figures_of_the_virtual_patient_or_a_motion_credit_no_person(self):
        bar = self.record("bar.h5", "--exercise", "cocktail-bar", duration=30)
        own = self.compare(bar)
        self.assertEqual(set(own.by), {VIRTUAL_PATIENT})
        drinks = [part for part in own.parts() if part[0] == "drink_done"]
        self.assertGreaterEqual(len(drinks), 1)
        self.expect(self.run_app("replay", bar, "--report", "page.html"), 0)
        said = report_data(self.folder / "page.html")["therapy"]
        self.assertEqual(said["sums"]["drink_done"]["others"], len(drinks))
        self.assertEqual(said["sums"]["drink_done"]["count"], 0)
        with read_recording(self.record("motion.h5")) as f:
            self.assertEqual(set(f["ticks/moved_by"][:]), {MOTION})


if __name__ == "__main__":
    main()
