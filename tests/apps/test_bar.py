"""`wholehand run` at the cocktail bar: the virtual patient plays a level, which is then simulated again."""

import numpy

from app import DONE, AppTest, main, read_recording

LEVER_M = 0.08  # lever of fingers and thumb, config/devices/lambda-pride.toml


class Level(AppTest):
    """Level 1, played once on the simulated clock; the tests check its recording."""

    @classmethod
    def setUpClass(cls):
        super().setUpClass()
        keeper = cls("run_level")
        keeper.setUp()
        cls.addClassCleanup(keeper.doCleanups)
        keeper.run_level()
        cls.recording = keeper.folder / "bar.h5"

    def run_level(self):
        result = self.run_app("run", "--simulated-clock", "--level", 1, "--duration", 20, "--record", "bar.h5")
        self.expect(result, DONE, "cocktail-bar, level 1", "Done after 20", "faults   none")

    def open(self):
        recording = read_recording(self.recording)
        self.addCleanup(recording.close)
        return recording

    def values(self, recording):
        names = [text.decode() for text in recording["meta"].attrs["value_names"]]
        return dict(zip(names, recording["ticks/exercise_values"][:].T))

    def test_level_is_completed(self):
        recording = self.open()
        meta, events = recording["meta"].attrs, recording["events"]
        self.assertEqual((meta["exercise"], meta["level"]), (b"cocktail-bar", 1))
        names = [text.decode() for text in meta["event_names"]]
        reported = [names[event] for event in events["type"][:]]
        self.assertEqual(reported[-1], "level_done", reported)
        # The order of the events in any play.
        order = [reported.index(name) for name in
                 ("approached", "engaged", "pour_began", "pour_ended", "step_done", "drink_done", "level_done")]
        self.assertEqual(order, sorted(order), reported)
        for mishap in ("overfilled", "spilt", "wrong_dispenser", "restarted"):
            self.assertNotIn(mishap, reported)
        last = {name: column[-1] for name, column in self.values(recording).items()}
        self.assertEqual(last["stage"], 5)  # level done, docs/exercises.md
        # The shipped file has one drink of 20 ml with a tolerance of 5 ml.
        self.assertAlmostEqual(last["poured_total_l"], 0.020, delta=0.005)
        self.assertEqual(last["spilt_l"], 0.0)
        self.assertAlmostEqual(events["value"][-1], last["score"], delta=1e-5)  # single precision
        self.assertGreaterEqual(last["score"], 70)  # accuracy of at least 0.8, nothing spilt: 95 · 0.8 − 0

    def test_resimulation_is_bit_identical(self):
        self.expect_same_when_run_again(self.recording)

    def test_volumes_add_up_in_every_tick(self):
        values = self.values(self.open())
        left = sum(column for name, column in values.items() if name.startswith("left_l/"))
        there = values["poured_total_l"] + values["spilt_l"] + left
        self.assertLess(abs(there - 0.35).max(), 1e-7)  # start_l of the only dispenser; single precision
        self.assertTrue((values["start_total_l"] == numpy.float32(0.35)).all())
        for name in ("poured_total_l", "spilt_l"):  # volumes never decrease
            self.assertTrue((values[name][1:] >= values[name][:-1]).all(), name)
        self.assertGreater(values["poured_total_l"][-1], 0.0)

    def test_flow_equals_the_missing_volume(self):
        # The missing volume is ∫ flow dt; a tick's flow belongs to that tick.
        values = self.values(self.open())
        self.assertAlmostEqual(values["flow_l_s"].sum() * 1e-3, values["poured_total_l"][-1], delta=1e-7)
        # d ẏ = f − k_s y − p₀ for each digit, and A ẏ flows, with the file's numbers. The displaced volume is A Σ y.
        recording = self.open()
        area, returns, opens, viscosity, length, radius = 4e-4, 25.0, 0.25, 0.157, 0.02, 0.002
        resistance = 8 * viscosity * length * area**2 / (numpy.pi * radius**4)
        axes = [text.decode() for text in recording["meta"].attrs["axis_names"]]
        tips = [-recording["ticks/exercise_effort"][:, axes.index(name)] / LEVER_M
                for name in ("finger_flexion", "thumb_flexion")]
        travel = values["pressed_l"] * 1e-3 / area
        law = 1e3 * area / resistance * (sum(tips) - 2 * opens - returns * travel)
        slit = numpy.roll(values["squeeze_n"], 1) >= 0.55  # the valve is wide open from 7 % above the threshold on
        both = numpy.minimum(*tips) > opens + returns * travel
        held = (recording["ticks/alpha"][:] == 1.0) & slit & both
        self.assertGreater(held.sum(), 100)
        self.assertLess(abs(values["flow_l_s"] - law)[held].max(), 1e-7)

    def test_wall_never_pulls(self):
        recording = self.open()
        effort, alpha = recording["ticks/exercise_effort"][:], recording["ticks/alpha"][:]
        axes = [text.decode() for text in recording["meta"].attrs["axis_names"]]
        for axis, name in enumerate(axes):
            if name in ("finger_flexion", "thumb_flexion"):
                # The fingers close towards larger angles, so a resisting effort is negative.
                self.assertLessEqual(effort[:, axis].max(), 0.0, name)
                self.assertLess(effort[:, axis].min(), -0.01, name)  # the wall acts
            else:
                self.assertFalse(effort[:, axis].any(), name)
        self.assertFalse(effort[alpha == 0.0].any())
        self.assertEqual((alpha.min(), alpha.max()), (0.0, 1.0))

    def test_wall_effort_follows_equation_15(self):
        # f_e = −α min(cap, k p) for p > 0: 280 N/m at the tip, the wall where the liquid has been displaced, 90 % of
        # the axis's 0.8 N·m.
        recording = self.open()
        ticks = {name: recording["ticks/" + name][:] for name in
                 ("exercise_effort", "alpha", "wall", "wall_active", "q_m")}
        axes = [text.decode() for text in recording["meta"].attrs["axis_names"]]
        for axis in (axes.index("finger_flexion"), axes.index("thumb_flexion")):
            depth = ticks["q_m"][:, axis] - ticks["wall"][:, axis]
            push = LEVER_M**2 * 280.0 * depth
            expected = -ticks["alpha"] * push.clip(0.0, 0.9 * 0.8)
            expected[(depth <= 0.0) | (ticks["wall_active"][:, axis] == 0.0)] = 0.0
            self.assertLess(abs(ticks["exercise_effort"][:, axis] - expected).max(), 5e-7)  # single precision of 2 rad

    def test_other_seed_moves_differently(self):
        def positions(seed):
            path = self.record(f"{seed}.h5", "--level", 1, "--seed", seed, duration=1.0)
            with read_recording(path) as recording:
                return recording["ticks/q_m"][:]

        first = self.open()["ticks/q_m"][:1001]
        same, other = positions(1), positions(2)
        self.assertTrue((same[:1000] == first[:1000]).all())
        self.assertTrue((same[:1000] != other[:1000]).any())


if __name__ == "__main__":
    main()
