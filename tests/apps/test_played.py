"""A session played from a page: its recording states who moved the hand, and its report counts it."""
import random
import struct
import time

import numpy

import client
from app import FULL, SEED, main, read_recording
from recount import PERSON, UNSPECIFIED, VIRTUAL_PATIENT, Compared
from test_sessions import Running

AIM, STEER = 4, 5  # commands/type
RESTART = 1        # kind of an action
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
            self.assertTrue(self.page.answer(self.page.say(client.ACTION, ("b", RESTART)))[0])
        for step in range(12):
            self.page.answer(self.page.say(client.STEER, ("b", draw.choice((0, 1, 1)))))
            for _ in range(draw.randrange(20)):
                by = [("B", draw.randrange(4))] if draw.random() < 0.9 else []
                self.page.say(client.AIM, struct.pack("<6f", -0.02 * draw.random(), 0.02 * draw.random(), 0.0, 0.3, 0.2, 0.1), *by)
                time.sleep(0.016)
            if step in (4, 9):
                self.page.answer(self.page.say(client.ACTION, ("b", RESTART)))
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


if __name__ == "__main__":
    main()
