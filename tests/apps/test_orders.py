"""A therapist's orders while a patient plays: how soon the loop obeys, and how soon the page shows it.

A player steers at 60 Hz, and three more pages receive every state. The therapist pauses and resumes; an order counts
as obeyed when a state shows it. States come 60 times a second, so up to 17 ms of each figure are the wait for the next
one. The time in the loop is that of the state's tick on the program's clock (CLOCK_MONOTONIC, as here)."""
import math
import struct
import threading
import time

import client
from app import FULL, HANG_S, PacedTest, main

PAUSE, RESUME = 2, 3           # protocol/wholehand.fbs, Act
RENDERING = 1                  # RunState
SENT_NS, RUN_STATE, VALUES, VALUE_NAMES = 3, 4, 24, 15  # fields of WorldState and Scene
ORDERS = 1000 if FULL else 60
OBEYED_S, SHOWN_P99_S = 0.100, 0.500


def share(sorted_s, part):
    return sorted_s[min(len(sorted_s) - 1, math.ceil(part * len(sorted_s)) - 1)]


class Orders(PacedTest):
    def setUp(self):
        super().setUp()
        run = self.start_app("run", "--port", 0, "--no-rehearsal")
        port = int(run.stdout.readline().strip().split(":")[2].rstrip("/"))
        self.pages = [client.Page(port, "watcher") for _ in range(3)]
        self.player, self.therapist = client.Page(port, "player"), client.Page(port, "therapist")
        self.pages += [self.player, self.therapist]
        self.until(lambda: self.therapist.scene and self.therapist.state
                   and self.therapist.state.number(RUN_STATE, "b") == RENDERING)
        self.player.hold_controls()
        accepted = self.player.answer(self.player.say(client.STEER, ("b", client.PERSON)))
        self.assertTrue(accepted[0], accepted[1])
        self.playing = True
        threading.Thread(target=self.play, daemon=True).start()

    def tearDown(self):
        self.playing = False
        for page in self.pages:
            page.close()
        super().tearDown()

    def until(self, so):
        end = time.monotonic() + HANG_S
        while not so():
            self.assertLess(time.monotonic(), end)
            time.sleep(0.01)

    def play(self):
        """Reaches to and fro with 60 aims a second, as a page sends them."""
        while self.playing and self.player.open:
            x_m = -0.05 + 0.03 * math.sin(time.monotonic())
            self.player.say(client.AIM, struct.pack("<6f", x_m, 0.02, 0.0, 0.8, 0.2, 0.1))
            time.sleep(1 / 60)

    def obeyed(self, count):
        """Delays (in the loop, until shown) of each order [s], sorted."""
        paused = self.therapist.scene.texts(VALUE_NAMES).index("paused")
        seen, came = [], threading.Condition()

        def look(state):
            values = state.doubles(VALUES)
            if len(values) <= paused:
                return  # a tick from before the exercise's first
            with came:
                seen.append((time.monotonic_ns(), state.number(SENT_NS, "q"), values[paused]))
                came.notify_all()

        self.therapist.on_state = look
        loop_s, shown_s = [], []
        for i in range(count):
            wanted, act = (1.0, PAUSE) if i % 2 == 0 else (0.0, RESUME)
            seen.clear()
            asked_ns = time.monotonic_ns()
            number = self.therapist.act(act)
            with came:
                self.assertTrue(came.wait_for(lambda: any(s[2] == wanted for s in seen), HANG_S), f"order {i} is not obeyed: {self.therapist.answer(number, 0)}, {len(seen)} states")
                shown_ns, tick_ns, _ = next(s for s in seen if s[2] == wanted)
            loop_s.append((tick_ns - asked_ns) * 1e-9)
            shown_s.append((shown_ns - asked_ns) * 1e-9)
            accepted = self.therapist.answer(number)
            self.assertTrue(accepted[0], accepted[1])
        self.therapist.on_state = lambda state: None
        return sorted(loop_s), sorted(shown_s)

    def test_orders_of_a_therapist_while_a_patient_plays_are_obeyed_at_once(self):
        loop_s, shown_s = self.obeyed(ORDERS)
        for name, times in (("in the loop", loop_s), ("on the page", shown_s)):
            print(f"figure: therapist's order obeyed {name}, {len(times)} orders: p50 {1e3 * share(times, 0.5):.1f} ms, "
                  f"p99 {1e3 * share(times, 0.99):.1f} ms, slowest {1e3 * times[-1]:.1f} ms", flush=True)
        # The slowest of few orders depend on the machine: ./check judges the median, --full also the slow ones.
        judged = 0.99 if FULL else 0.5
        self.assertLessEqual(share(loop_s, judged), OBEYED_S)
        self.assertLessEqual(share(shown_s, judged), SHOWN_P99_S)
        # The player steered all the time, and nobody took the controls.
        self.assertTrue(self.player.answer(self.player.say(client.STEER, ("b", client.PERSON)))[0])


if __name__ == "__main__":
    main()
