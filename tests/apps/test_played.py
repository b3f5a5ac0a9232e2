"""A session played from a page: its recording states who moved the hand and for how long, and its report counts it."""
import json
import random
import struct
import time

import numpy

import client
from app import DONE, FULL, SEED, main, read_recording, report_data
from recount import FULL_HELP, NO_HELP, PERSON, UNSPECIFIED, VIRTUAL_PATIENT, Compared
from test_sessions import Running

AIM, STEER = 4, 5  # commands/type
NEXT, RESTART, PAUSE, RESUME = range(4)  # kinds of an action
INTENTION, ACTIVE_S = 12, 45  # fields of WorldState
CASES = 60 if FULL else 3


class Played(Running, Compared):
    def test_recording_of_a_page_credits_the_movers_of_its_orders(self):
        """Hand-overs at random moments: the columns must follow the recorded commands in every tick."""
        run = self.start("--record", "run.h5", "--exercise", "cocktail-bar")
        draw = random.Random(SEED)
        accepted, reason = self.page.arm(self.endings)
        self.assertTrue(accepted, reason)
        # The virtual patient makes a drink, the page restarts the level, and the patient makes the next.
        for begun_s in (9, 18):
            self.wait_until(run, lambda: self.page.state is not None and self.page.state.number(1, "Q") > 1000 * begun_s)
            self.assertTrue(self.page.answer(self.page.act(RESTART))[0])
        for step in range(12):
            self.page.answer(self.page.say(client.STEER, ("b", draw.choice((0, 1, 1)))))
            for _ in range(draw.randrange(20)):
                by = [("B", draw.randrange(4))] if draw.random() < 0.9 else []
                self.page.say(client.AIM, struct.pack("<6f", -0.02 * draw.random(), 0.02 * draw.random(), 0.0, 0.3, 0.2, 0.1), *by)
                time.sleep(0.016)
            if step in (4, 9):
                self.page.answer(self.page.act(RESTART))
            if step == 7:  # the page stalls, loses the controls and takes them again
                self.page.fall_silent()
                time.sleep(0.5)
                self.page.hold_controls()
        self.assertTrue(self.page.answer(self.page.say(client.EMERGENCY_STOP))[0])
        self.page.wait_for_endings(self.endings + 2)
        self.end(run)
        own = self.compare(self.folder / "run.h5")
        with read_recording(self.folder / "run.h5") as f:
            commands = list(zip(*(f[f"commands/{name}"][:] for name in ("row", "type", "index"))))
            aims = f["commands/aim"][:]
        by, help = numpy.full(len(own.by), VIRTUAL_PATIENT), numpy.zeros(len(own.by), int)
        for (row, kind, index), aim in zip(commands, aims):
            if kind == STEER and (index == 1) != (by[row] == PERSON):
                by[row:] = PERSON if index == 1 else VIRTUAL_PATIENT
                help[row:] = UNSPECIFIED
            elif kind == AIM and by[row] == PERSON and numpy.isfinite(aim).all():
                help[row:] = index
        numpy.testing.assert_array_equal(own.by, by)
        numpy.testing.assert_array_equal(own.help, help)
        self.assertEqual(set(own.by), {PERSON, VIRTUAL_PATIENT})
        self.assertGreaterEqual(len(set(own.help)), 3)
        self.assertGreaterEqual([name for _, name, *_ in own.events].count("drink_done"), 2)
        self.assertGreaterEqual([name for _, name, *_ in own.events].count("restarted"), 2)
        self.compare_drawn([self.folder / "run.h5"], CASES)

    def play(self, seconds, speed_m_s, help):
        """Aims 60 times a second of the program's time, with a speed along x; returns the ticks of the first and last aim."""
        ticks = [self.page.state.number(1, "Q")]
        while ticks[-1] < ticks[0] + 1000 * seconds:
            self.place[0] += speed_m_s / 60
            self.page.say(client.AIM, struct.pack("<6f", *self.place), ("B", help))
            time.sleep(0.016)
            ticks.append(self.page.state.number(1, "Q"))
        return ticks[0], ticks[-1]

    def test_a_script_counted_by_hand_has_its_active_and_led_time(self):
        """3 s of still aims, 1 s of moving ones, 4 s still; 2.5 s in a pause, most of them moving; 3 s still; 1 s with full help; then
        nobody holds the controls. Active: from the first movement to 2 s after the last, and the filter of the aim
        comes to rest within 0.5 s. Led: the same of the aims with full help, until the controls are lost."""
        run = self.start("--record", "run.h5", "--exercise", "cocktail-bar")
        accepted, reason = self.page.arm(self.endings)
        self.assertTrue(accepted, reason)
        self.wait_until(run, lambda: self.page.state is not None and self.page.state.number(1, "Q") > 100)
        self.assertTrue(self.page.answer(self.page.say(client.STEER, ("b", 1)))[0])
        tick = self.page.state.number(1, "Q")
        self.wait_until(run, lambda: self.page.state.number(1, "Q") > tick + 1000)  # the hand comes to rest
        self.place = list(self.page.state.floats(INTENTION))
        self.play(3, 0.0, NO_HELP)
        begins, ends = self.play(1, 0.05, NO_HELP)
        self.play(4, 0.0, NO_HELP)
        self.assertTrue(self.page.answer(self.page.act(PAUSE))[0])
        self.play(2, -0.02, NO_HELP)
        self.play(0.5, 0.0, NO_HELP)
        self.assertTrue(self.page.answer(self.page.act(RESUME))[0])
        self.play(3, 0.0, NO_HELP)
        led, led_ends = self.play(1, 0.05, FULL_HELP)
        shown_s = self.page.state.number(ACTIVE_S, "f")
        self.page.fall_silent()
        time.sleep(2.0)
        run.kill()  # and so the session is broken off
        run.communicate()
        measured = json.loads(self.expect(self.run_app("measures", "run.h5"), DONE).out)
        tolerance_s = 0.1  # between a state on its way to the page and an aim on its way to the loop
        active_s = 2.0 + (ends - begins) / 1000
        self.assertGreater(measured["active_s"], active_s - tolerance_s)
        self.assertLess(measured["active_s"], active_s + 0.5 + tolerance_s)
        self.assertGreater(measured["led_s"], (led_ends - led) / 1000 - 2 * tolerance_s)
        self.assertLess(measured["led_s"], (led_ends - led) / 1000 + 2.0 + tolerance_s)
        self.assertEqual(measured["helped_s"], 0.0)
        self.assertAlmostEqual(shown_s, measured["active_s"], delta=tolerance_s)
        self.assertEqual((measured["ended_by"], measured["recording"]["complete"]), ("broken_off", False))
        said = self.expect(self.run_app("replay", "--speed", 1000, "run.h5"), DONE)
        self.assertIn("broken off", said.out)
        self.expect(self.run_app("replay", "run.h5", "--report", "page.html"), DONE)
        self.assertEqual(report_data(self.folder / "page.html")["about"]["ended_by"], "broken_off")


if __name__ == "__main__":
    main()
