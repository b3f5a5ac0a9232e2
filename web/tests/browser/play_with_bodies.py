"""Plays a game with bodies in a running program, for the tests of recordings: play_with_bodies.py HOST:PORT

A ball falls on the hand, others of every shape stand and lie beside it; some are known by numbers; all leave at the end."""
import sys
import time

import numpy

from wholehand.bodies import FIXED, GAME, Body, ball, box, capsule, cylinder, mesh
from wholehand.client import Client
from wholehand.connection import PERSON, Refused

RENDERING = 1
TURNED = (0.0, 0.3826834, 0.0, 0.9238795)  # 45 degrees about y
CORNERS = [(0.05, 0, 0), (-0.05, 0, 0), (0, 0.05, 0), (0, -0.05, 0), (0, 0, 0.06), (0, 0, -0.06)]
FACES = [(0, 2, 4), (2, 1, 4), (1, 3, 4), (3, 0, 4), (2, 0, 5), (1, 2, 5), (3, 1, 5), (0, 3, 5)]


def ask(program, order, *arguments, **fields):
    """On a busy machine a heartbeat may be late, and the controls are lost: they are taken again."""
    for _ in range(20):
        try:
            return order(*arguments, **fields)
        except Refused as refused:
            if refused.code != "NotHolder":
                raise
            program.take_controls()
    raise SystemExit("the controls are lost again and again")


def wait(program, seconds, hold):
    until = time.monotonic() + seconds
    while time.monotonic() < until:
        ask(program, program.order, "Aim", q=hold)
        program.next_state()


def main():
    with Client(sys.argv[1]) as program:
        program.take_controls()
        ask(program, program.arm)
        while program.next_state().run_state != RENDERING or len(program.state.links) == 0:
            pass
        ask(program, program.order, "Steer", by=PERSON)
        hold = program.state.q_s.copy()
        wait(program, 1.0, hold)
        middle = numpy.mean(program.state.links["position_m"], axis=0)
        for shape_set, shape in enumerate((ball(0.03), box((0.06, 0.05, 0.04)), capsule(0.02, 0.08), cylinder(0.03, 0.08),
                                           mesh(CORNERS, FACES))):
            ask(program, program.prepare_shapes, shape_set, shape)
        beside = middle + (0.0, 0.2, 0.0)
        ask(
            program, program.spawn,
            Body(slot=0, shape_set=0, position_m=middle + (0.0, 0.0, 0.12), mass_kg=0.2),
            Body(slot=1, shape_set=1, owner=FIXED, position_m=beside),
            Body(slot=2, shape_set=2, owner=FIXED, position_m=beside + (0.0, 0.0, 0.12), orientation_xyzw=TURNED),
            Body(slot=3, shape_set=3, owner=GAME, position_m=beside - (0.0, 0.4, 0.0)),
            Body(slot=4, shape_set=4, owner=FIXED, position_m=beside - (0.0, 0.4, -0.15)))
        ask(program, program.spawn, *(Body(slot=1000 + i, shape_set=0, owner=FIXED, position_m=middle + (0.2, 0.08 * (i - 3), 0.1))
                        for i in range(7)))
        wait(program, 1.5, hold)
        ask(program, program.remove, *((1000 + i, 1) for i in range(7)))
        ask(program, program.remove, (0, 1), (1, 1), (2, 1), (3, 1), (4, 1))
        wait(program, 1.0, hold)
        ask(program, program.stop)
        while program.next_state().run_state == RENDERING:
            pass


if __name__ == "__main__":
    main()
