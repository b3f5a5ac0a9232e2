"""Drops a ball on the hand of a running program, and prints its events.

    wholehand run --exercise game-scene --wait     # in another terminal
    python3 drop_a_ball.py                         # --address host:port otherwise
"""
import argparse
import sys
import time

import numpy

from wholehand.bodies import Body, ball
from wholehand.client import Client
from wholehand.connection import PERSON, Lost, Refused
from wholehand.kinematics import matrices

RENDERING, PALM = 1, 0
RADIUS_M, ABOVE_M = 0.03, 0.15


def palm_m(scene, state):
    """Middle of the palm in the world."""
    links = matrices(state.links)
    capsules = [c for c in scene.capsules if c.part == PALM]
    return numpy.mean([links[c.link][:3, :3] @ (0.5 * (c.a_m + c.b_m)) + links[c.link][:3, 3] for c in capsules], axis=0)


def drop(program, seconds):
    program.take_controls()
    if program.next_state().run_state != RENDERING:
        program.arm()
    while program.next_state().run_state != RENDERING or len(program.state.links) == 0:
        pass
    program.order("Steer", by=PERSON)
    hold = program.state.q_s.copy()
    program.prepare_shapes(0, ball(RADIUS_M))
    program.spawn(Body(slot=0, shape_set=0, position_m=palm_m(program.scene, program.state) + (0.0, 0.0, ABOVE_M),
                       mass_kg=0.2))
    event = program.next_body_event(timeout_s=10.0)
    while event.name != "solid":
        print(f"{event.name} {event.refusal}".rstrip())
        event = program.next_body_event(timeout_s=10.0)
    print("solid")
    most_n, until = 0.0, time.monotonic() + seconds
    first_body = len(program.scene.bodies)
    while time.monotonic() < until:
        program.order("Aim", q=hold)
        contacts = program.next_state().contacts
        on_ball = contacts["force_n"][contacts["body"] == first_body]
        if len(on_ball):
            most_n = max(most_n, float(numpy.linalg.norm(on_ball.sum(axis=0))))
    program.remove((0, 1))
    while event.name != "left":
        event = program.next_body_event(timeout_s=10.0)
        if event.name == "touched":
            print(f"touched with {event.impulse_ns:.4f} N·s")
    print(f"left; it pressed with {most_n:.2f} N at most")


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--address", default="127.0.0.1:8080")
    parser.add_argument("--seconds", type=float, default=1.0, help="until the ball is removed")
    options = parser.parse_args()
    try:
        with Client(options.address) as program:
            drop(program, options.seconds)
    except (Lost, Refused) as error:
        sys.exit(str(error))


if __name__ == "__main__":
    main()
