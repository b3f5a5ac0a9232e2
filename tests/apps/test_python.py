"""The Python package as its users call it: a client of the running program, the hand's kinematics, recordings."""
import asyncio
import contextlib
import importlib
import io
import os
import pathlib
import pkgutil
import random
import re
import signal
import subprocess
import sys
import time
import unittest

import numpy
from app import BINARY, FULL, HANG_S, SEED, SOURCE, AppTest, PacedTest, main

import wholehand
import wholehand.protocol
from wholehand import messages
from wholehand.bodies import FIXED, GAME, Body, ball, box, mesh
from wholehand.client import HUNG_AFTER_S, Client
from wholehand.connection import NEXT, PERSON, Lost, Refused, Unanswered, connect
from wholehand.kinematics import Hand, matrices

MUTATIONS = 100_000 if FULL else 300
RENDERING, STOPPED = 1, 3


class Connected(PacedTest):
    """A program with the bar, waiting to be armed."""
    options = ()

    def setUp(self):
        super().setUp()
        self.run = self.start_app("run", "--port", 0, "--wait", "--no-rehearsal", *self.options)
        self.address = self.run.stdout.readline().strip().split("//")[1].rstrip("/")
        self.program = Client(self.address, role="therapist")
        self.addCleanup(self.program.close)

    def states_until(self, so):
        until = time.monotonic() + HANG_S
        while not so(self.program.next_state(timeout_s=60.0)):
            self.assertLess(time.monotonic(), until)
        return self.program.state

    def play(self):
        self.program.take_controls()
        self.program.arm()
        self.states_until(lambda state: state.run_state == RENDERING)


class ClientTest(Connected):
    def test_scene_and_states_have_the_names_of_the_schema(self):
        scene = self.program.scene
        self.assertEqual([axis.name for axis in scene.axes][:4], ["x", "y", "z", "finger_flexion"])
        self.assertEqual(scene.axes[0].unit, "m")
        self.assertEqual(scene.exercise_name, "cocktail-bar")
        self.play()
        state = self.program.state
        self.assertEqual(state.q_s.shape, (6,))
        self.assertEqual(state.qd_s.shape, (6,))
        self.assertEqual(len(state.bodies), len(scene.bodies))
        self.assertEqual(state.bodies["position_m"].shape, (len(scene.bodies), 3))
        self.assertEqual(len(state.theta), len(scene.joint_names))
        with self.assertRaisesRegex(AttributeError, "WorldState has no field 'q_ss'.*theta"):
            state.q_ss  # noqa: B018

    def test_joints_are_predicted_from_the_last_states(self):
        self.play()
        for _ in range(20):
            state = self.program.next_state(timeout_s=60.0)
        joints = self.program.joints_now()
        self.assertEqual(joints.shape, state.theta.shape)
        # The prediction is ahead by at most 50 ms of motion; the device's largest speed is 10 rad/s.
        self.assertLess(abs(joints - state.theta).max(), 0.5)

    def test_links_and_joints_lead_to_the_poses_that_the_program_draws(self):
        self.play()
        hand = Hand(self.program.scene)
        self.assertEqual(hand.names, self.program.scene.link_names)
        states = [self.program.next_state(timeout_s=60.0) for _ in range(60)]
        poses = hand.link_poses(numpy.array([state.theta for state in states]))
        said = numpy.array([matrices(state.links) for state in states])
        self.assertEqual(poses.shape, said.shape)
        # Tolerance: single precision through a chain of links, some 1e-6 m and rad.
        self.assertLess(abs(poses - said).max(), 5e-6)
        self.assertGreater(abs(said[0] - said[-1]).max(), 1e-4, "the virtual patient moves the hand")
        with self.assertRaisesRegex(ValueError, "theta has 2 joints; this hand has 19"):
            hand.link_poses([0.0, 1.0])

    def test_person_steers_the_hand(self):
        self.play()
        self.program.order("Steer", by=PERSON)
        aim = self.program.state.q_s.copy()
        aim[1] += 0.03
        before = self.program.state.q_s[1]

        def there(state):
            self.program.order("Aim", q=aim)
            return abs(state.q_s[1] - before - 0.03) < 0.01
        self.states_until(there)

    def test_refused_order_gives_the_reason(self):
        with Client(self.address, role="watcher") as watcher, self.assertRaises(Refused) as refused:
            watcher.take_controls()
        self.assertEqual(refused.exception.code, "OnlyWatches")
        self.program.take_controls()
        for code, order, fields in (("UnknownParameter", "SetParameter", {"name": "no_such", "value": 1.0}),
                                    ("UnknownExercise", "LoadExercise", {"exercise": "chess"}),
                                    ("NothingArmed", "Action", {"act": NEXT}),
                                    ("StopNotSeen", "Arm", {"endings_seen": 7})):
            with self.assertRaises(Refused) as refused:
                self.program.order(order, **fields)
            self.assertEqual(refused.exception.code, code)
            self.assertIn(order, str(refused.exception))
        with self.assertRaisesRegex(ValueError, "there is no order 'Jump'; there are Arm"):
            self.program.order("Jump")
        with self.assertRaisesRegex(ValueError, "Arm has no field 'height'"):
            self.program.order("Arm", height=1)

    def test_non_finite_number_raises_at_once_and_is_not_sent(self):
        self.play()
        self.program.order("Steer", by=PERSON)
        aim = self.program.state.q_s.astype(float)
        for at, number in ((0, numpy.nan), (5, -numpy.inf), (2, 1e39)):  # 1e39 is infinite in single precision
            bad = aim.copy()
            bad[at] = number
            with self.assertRaisesRegex(ValueError, re.escape(f"Aim.q[{at}] = {number}: must be finite")):
                self.program.order("Aim", q=bad)
        for number in (float("nan"), numpy.float64("inf")):
            with self.assertRaisesRegex(ValueError, rf"SetParameter\.value = {number}: must be finite"):
                self.program.order("SetParameter", name="help", value=number)
        self.program.order("Aim", q=aim)

    def test_aim_far_beyond_the_range_is_refused_by_name(self):
        self.play()
        self.program.order("Steer", by=PERSON)
        aim = self.program.state.q_s.astype(float)
        for number in (1e9, -1e9):
            with self.assertRaisesRegex(Refused, r"Aim: an aim of x = -?1e\+09 m: is far beyond the range .*NotAPosture"):
                self.program.order("Aim", q=numpy.array([number, *aim[1:]]))
        axis = self.program.scene.axes[0]
        self.program.order("Aim", q=numpy.array([3.0 * axis.upper, *aim[1:]]))  # the arm moves to the end of its range

    def test_orders_in_quick_succession_are_all_answered(self):
        """The program drops orders beyond 400 a second, an Aim without an answer; the client must not send faster."""
        self.play()
        self.program.order("Steer", by=PERSON)
        aim = self.program.state.q_s.copy()
        for _ in range(1000):
            self.program.order("Aim", timeout_s=HANG_S, q=aim)

    def test_orders_to_a_hanging_program_raise_in_time(self):
        self.program.take_controls()
        self.run.send_signal(signal.SIGSTOP)
        for ask in (lambda: self.program.order("Stop", timeout_s=0.5), lambda: self.program.order("Arm", timeout_s=0.5)):
            with self.assertRaisesRegex(Unanswered, r"the program did not answer within 0\.5 s"):
                ask()
        with self.assertRaises(TimeoutError):
            self.program.next_state(timeout_s=0.5)
        self.run.send_signal(signal.SIGCONT)
        self.program.order("Stop")

    def test_emergency_stop_needs_no_controls(self):
        self.play()
        with Client(self.address, role="watcher") as watcher:
            watcher.emergency_stop()
            state = self.states_until(lambda state: state.run_state == STOPPED)
        self.assertTrue((state.sent == 0).all())

    def test_hanging_caller_loses_the_controls(self):
        self.play()
        # A long call is no hang, such as an arming whose rehearsal takes 4 s.
        self.program._call(asyncio.sleep(HUNG_AFTER_S + 1.0))
        self.assertTrue(self.program.controls.held_by_you)
        self.program._called_s = float("-inf")  # the state after 3 s without a call
        with Client(self.address, role="watcher") as watcher:
            until = time.monotonic() + HANG_S
            while watcher.controls.held:
                self.assertLess(time.monotonic(), until)
                watcher.next_state(timeout_s=60.0)

    def test_end_of_the_program_is_reported_at_the_next_call(self):
        self.run.kill()
        self.run.wait()
        with self.assertRaisesRegex(Lost, "the connection to the program ended"):
            while True:
                self.program.next_state(timeout_s=60.0)

    def test_missing_program_is_reported_with_the_remedy(self):
        with self.assertRaisesRegex(Lost, "no program answers at ws://127.0.0.1:1/ws.*wholehand run"):
            Client("127.0.0.1:1")
        with self.assertRaisesRegex(ValueError, "role = 'dancer': must be therapist, player or watcher"):
            Client(self.address, role="dancer")

    def test_asyncio_receives_events_by_name(self):
        async def play():
            async with connect(self.address, role="therapist") as program:
                await program.take_controls()
                await program.arm()
                async for name, event in program.events():
                    return name, event, program.scene.event_names
        name, event, names = asyncio.run(asyncio.wait_for(play(), 100))
        self.assertIn(name, names)
        self.assertEqual(names[event["type"]], name)

    def test_corrupted_messages_give_values_or_message_errors(self):
        self.play()
        seen = [bytes(table._generated._tab.Bytes) for table in (self.program.state, self.program.scene)]
        draws = random.Random(SEED)
        unreadable = 0
        for _ in range(MUTATIONS):
            data = bytearray(draws.choice(seen))
            for _ in range(draws.randint(1, 8)):
                data[draws.randrange(len(data))] = draws.randrange(256)
            if draws.random() < 0.2:
                del data[draws.randrange(len(data)):]
            unreadable += not readable(bytes(data))
        self.assertTrue(readable(seen[0]) and readable(seen[1]))
        self.assertGreater(unreadable, MUTATIONS // 100)


class BodiesTest(Connected):
    """A program with a scene that accepts bodies of a game, waiting to be armed."""
    options = ("--exercise", SOURCE / "config/exercises/game-scene.toml")
    ASIDE_M = numpy.array([0.5, 0.3, 0.2])

    def becomes(self, name, slot=0):
        while True:
            event = self.program.next_body_event(timeout_s=60.0)
            if (event.name, event.slot) == (name, slot):
                return event

    def test_body_is_spawned_moved_shown_and_removed(self):
        self.play()
        self.program.prepare_shapes(0, ball(0.03))
        self.program.spawn(Body(slot=2, generation=7, shape_set=0, owner=GAME, position_m=self.ASIDE_M))
        self.assertEqual(self.becomes("solid", 2).generation, 7)
        index = len(self.program.scene.bodies) + 2
        goal = self.ASIDE_M + (0.0, 0.05, 0.0)

        def there(state):
            self.program.body_targets((2, 7, goal))
            return abs(state.bodies["position_m"][index] - goal).max() < 2e-3
        self.states_until(there)
        reported = self.program.bodies
        self.assertEqual([(b["slot"], b["generation"]) for b in reported.bodies], [(2, 7)])
        self.assertEqual(messages.SLOT_STATES[reported.bodies[0]["state"]], "Solid")
        self.program.set_owner((2, 7, FIXED))
        self.program.teleport((2, 7, self.ASIDE_M))
        self.states_until(lambda state: abs(state.bodies["position_m"][index] - self.ASIDE_M).max() < 1e-6)
        self.program.remove((2, 7))
        self.assertEqual(self.becomes("left", 2).generation, 7)
        self.states_until(lambda _: len(self.program.bodies.bodies) == 0)

    def test_registered_bodies_are_shown_and_simulated_near_the_hand(self):
        self.play()
        self.program.prepare_shapes(0, ball(0.03))
        near = [Body(slot=1000 + i, shape_set=0, owner=FIXED, position_m=(0.1, 0.25, 0.1 * i)) for i in range(3)]
        far = [Body(slot=2000 + i, generation=4, shape_set=0, position_m=(3.0, 0.05 * i, 0.0)) for i in range(61)]
        self.program.spawn(*near, *far)

        def where(number):
            body = self.program.registered.get(number)
            return body is not None and messages.WHEREABOUTS[int(body["whereabouts"])]
        self.states_until(lambda _: all(where(1000 + i) == "InSlot" for i in range(3)))
        self.assertEqual(len(self.program.registered), 64)
        self.assertEqual({where(2000 + i) for i in range(61)}, {"OutOfReach"})
        self.assertEqual(self.program.registered[2060]["generation"], 4)
        solid = self.becomes("solid")
        self.assertIn(solid.body, [(1000, 1), (1001, 1), (1002, 1)])
        numpy.testing.assert_allclose(self.program.registered[2060]["pose"]["position_m"], (3.0, 3.0, 0.0), atol=1e-6)
        slot = int(self.program.registered[1000]["slot"])
        index = len(self.program.scene.bodies) + slot
        self.states_until(lambda state: len(state.bodies) > index
                          and abs(state.bodies["position_m"][index] - (0.1, 0.25, 0.0)).max() < 1e-6)
        poses = self.program.body_poses()
        self.assertEqual(set(poses), {body.slot for body in near + far})
        for body in near + far:
            numpy.testing.assert_allclose(poses[body.slot]["position_m"], body.position_m, atol=1e-6)
        with self.assertRaises(Refused) as refused:
            self.program.spawn(Body(slot=1000, shape_set=0, position_m=self.ASIDE_M))
        self.assertEqual(refused.exception.items[0][1], "SlotTaken")
        self.program.remove((1000, 1), (2060, 4))
        self.states_until(lambda _: len(self.program.registered) == 62)

    def test_refused_items_are_named(self):
        self.program.take_controls()
        with self.assertRaises(Refused) as refused:
            self.program.teleport((0, 1, self.ASIDE_M))
        self.assertEqual(refused.exception.code, "NothingArmed")
        self.program.prepare_shapes(2, ball(0.03))  # kept for the next arming
        self.program.spawn(Body(slot=5, generation=3, shape_set=2, position_m=self.ASIDE_M + (0.0, 0.2, 0.0)))
        self.program.arm()
        self.states_until(lambda state: state.run_state == RENDERING)
        self.assertEqual(self.becomes("solid", 5).generation, 3)
        corners = [(0, 0, 0), (0.05, 0, 0), (0, 0.05, 0), (0, 0, 0.05)]
        faces = [(0, 2, 1), (0, 1, 3), (0, 3, 2), (1, 2, 3)]
        self.program.prepare_shapes(1, mesh(corners, faces), box((0.02, 0.03, 0.04), position_m=(0.1, 0, 0)))
        with self.assertRaises(Refused) as refused:
            self.program.prepare_shapes(0, mesh(corners, faces[1:]), ball(0.03))
        self.assertEqual(refused.exception.code, "BodiesRefused")
        self.assertEqual(refused.exception.items[0][:2], (0, "BadShapes"))
        self.assertIn("watertight", refused.exception.items[0][2])
        good = Body(slot=0, shape_set=1, position_m=self.ASIDE_M)
        with self.assertRaises(Refused) as refused:
            self.program.spawn(good, Body(slot=1, shape_set=1, position_m=(9, 0, 0)),
                               Body(slot=64, shape_set=1, position_m=self.ASIDE_M))
        self.assertEqual([item[:2] for item in refused.exception.items], [(1, "BadPose"), (2, "NoSuchSlot")])
        self.becomes("solid")  # the valid order
        self.program.remove((0, 3))
        self.assertEqual(self.becomes("refused").refusal, "WrongGeneration")
        with Client(self.address) as other, self.assertRaises(Refused) as refused:
            other.remove((0, 1))
        self.assertEqual(refused.exception.code, "NotHolder")

    def test_example_drops_a_ball_on_the_hand(self):
        self.program.close()
        done = subprocess.run([sys.executable, "-B", SOURCE / "clients/python/examples/drop_a_ball.py", "--address", self.address],
                              cwd=SOURCE, capture_output=True, text=True, timeout=HANG_S,
                              env={**os.environ, "PYTHONPATH": str(BINARY.parent / "python")})
        self.assertEqual(done.returncode, 0, done.stderr)
        self.assertRegex(done.stdout, r"solid\n(touched with [\d.]+ N·s\n)+left; it pressed with [\d.]+ N at most")
        # It falls from 0.15 m above the centre of the palm, at 1.5 m/s at most: 0.2 kg have 0.31 N·s.
        self.assertTrue(0.005 < float(re.search(r"with ([\d.]+) N·s", done.stdout).group(1)) < 0.35, done.stdout)
        self.assertGreater(float(re.search(r"pressed with ([\d.]+) N", done.stdout).group(1)), 0.1)


def block(heading):
    """The first Python code of README.md under a heading."""
    return (SOURCE / "clients/python/README.md").read_text().split(f"\n## {heading}\n")[1].split("```python\n")[1].split("```")[0]


class Readme(Connected):
    """The code of clients/python/README.md, run unchanged."""
    options = ("--exercise", "game-scene")

    def ran(self, heading, **names):
        """Runs the code under a heading and returns its names."""
        with contextlib.redirect_stdout(io.StringIO()) as self.said:
            exec(block(heading).replace("127.0.0.1:8080", self.address), names)  # noqa: S102
        return names

    def test_steering_code_runs(self):
        names = self.ran("Steer the hand")
        self.assertGreaterEqual(len(self.said.getvalue().splitlines()), 300)  # long arrays take two lines
        self.assertTrue(numpy.isfinite(names["state"].sent).all())

    def test_code_for_bodies_and_links_runs(self):
        self.ran("Bring bodies", program=self.program)
        self.states_until(lambda _: len(self.program.bodies.bodies) == 0)  # the bodies are removed at the end
        poses = self.ran("Where the links are", program=self.program, state=self.program.state)["poses"]
        self.assertEqual(poses.shape, (len(self.program.scene.links), 4, 4))

    def test_code_for_recordings_runs(self):
        self.record(duration=0.3)
        before = os.getcwd()
        self.addCleanup(os.chdir, before)
        os.chdir(self.folder)
        names = self.ran("Recordings")
        self.assertEqual(names["frame"].columns.get_level_values(0).unique().tolist(), ["q_m", "sent"])
        self.assertIn("bodies", names["data"])


def readable(data):
    """Whether the whole message can be read; any exception except MessageError is raised."""
    try:
        message = messages.decode(data)
        for name in messages.field_names(type(message._generated)):
            value = getattr(message, name)
            if isinstance(value, list) and value and isinstance(value[0], messages.Table):
                for field in messages.field_names(type(value[0]._generated)):
                    getattr(value[0], field)
        return True
    except messages.MessageError:
        return False


class Messages(unittest.TestCase):
    def test_structs_have_the_sizes_of_flatc(self):
        for name, dtype in messages.STRUCTS.items():
            generated = getattr(importlib.import_module(f"wholehand.protocol.{name}"), name)
            self.assertEqual(generated.SizeOf(), dtype.itemsize, name)

    def test_every_field_of_the_schema_is_accessible(self):
        schema = (pathlib.Path(__file__).resolve().parents[2] / "protocol/wholehand.fbs").read_text()
        tables = 0
        for module in pkgutil.iter_modules(wholehand.protocol.__path__):
            generated = getattr(importlib.import_module(f"wholehand.protocol.{module.name}"), module.name)
            _, found, after = schema.partition(f"table {module.name} {{")
            if not found:
                continue
            tables += 1
            lines = (line.partition("//")[0] for line in after.partition("}")[0].splitlines())
            names = [part.partition(":")[0].strip() for line in lines for part in line.split(";") if ":" in part]
            for name in names:
                if (module.name, name) not in (("Message", "payload"), ("Command", "order")):
                    self.assertIn(name, messages.field_names(generated), module.name)
                    messages._reader(generated, name)
        self.assertGreater(tables, 30)

    def test_invalid_bytes_are_refused_with_the_reason(self):
        heartbeat = messages.encode(1, "Heartbeat")
        self.assertEqual(messages.decode(heartbeat).kind, "Command")
        for data, why in ((b"", "not a message of Wholehand's"), (b"\0\0\0\0ABCD", "not a message of Wholehand's"),
                          (heartbeat[:9], "not a message")):
            with self.assertRaisesRegex(messages.MessageError, why):
                messages.decode(data)
        version = messages.SCHEMA_VERSION
        try:
            messages.SCHEMA_VERSION = 9
            other = messages.encode(1, "Heartbeat")
        finally:
            messages.SCHEMA_VERSION = version
        with self.assertRaisesRegex(messages.MessageError, "schema_version = 9; this client reads 1"):
            messages.decode(other)


class Recordings(AppTest):
    def test_datasets_become_tables_with_names_and_units(self):
        with wholehand.open(self.record(duration=0.5)) as run:
            frame, data = run.to_pandas("q_m", "bodies"), run.to_xarray("q_m", "sent", "bodies")
            numbers = run["ticks/q_m"][:]
            with self.assertRaisesRegex(KeyError, "speed: there is no such dataset in /ticks; there are alpha"):
                run.to_pandas("speed")
        self.assertTrue((frame["q_m"]["finger_flexion"].to_numpy() == numbers[:, 3]).all())
        self.assertEqual(frame.attrs["units"]["q_m", "finger_flexion"], "rad")
        self.assertIn(("bodies", "cube px"), frame.columns)
        self.assertTrue((data["q_m"].sel(axis="x").to_numpy() == numbers[:, 0]).all())
        self.assertEqual(data["bodies"].dims, ("time_s", "body", "bodies_columns"))
        self.assertEqual(data["sent"].attrs["units"][0], "N")
        self.assertAlmostEqual(float(data["time_s"][-1]), 1e-3 * (len(numbers) - 1))

    def test_every_access_to_ticks_gives_decoded_numbers(self):
        with wholehand.open(self.record(duration=0.2)) as run:
            numbers = run["ticks/qd_s"][:]
            self.assertTrue((run.to_pandas("qd_s")["qd_s"].to_numpy() == numbers).all())
            for ticks in (run.ticks, run["ticks"], run["/ticks/"]):
                self.assertTrue((numpy.asarray(ticks["qd_s"]) == numbers).all())
                self.assertIn("qd_s", ticks)
                self.assertEqual(len(list(ticks)), len(ticks))
                self.assertRaises(KeyError, lambda ticks=ticks: ticks["speed"])


class Examples(AppTest):
    def said(self, name, *arguments):
        done = subprocess.run([sys.executable, "-B", SOURCE / "clients/python/examples" / name, *map(str, arguments)],
                              cwd=SOURCE, capture_output=True, text=True, timeout=HANG_S,
                              env={**os.environ, "PYTHONPATH": str(BINARY.parent / "python")})
        self.assertEqual(done.returncode, 0, done.stderr)
        return done.stdout

    def test_recording_example_runs(self):
        said = self.said("look_at_a_recording.py", self.record(duration=0.5))
        self.assertRegex(said, r"Four shapes, reach-grasp-00: \d+ ticks, 0\.5\d s, touching for 0\.00 s")
        self.assertRegex(said, r"finger_flexion +[\d.]+ rad +[\d.]+ N·m")

    # Without contact, the coupling's spring only accelerates the hand: twice the stiffness gives about half the lag.
    def test_stiffer_coupling_lags_less_until_it_is_refused(self):
        said = self.said("sweep_a_gain.py", "--program", BINARY, "--stiffness", 400, 800, 4000, "--seconds", 1.5)
        lags_mm = [float(lag) for lag in re.findall(r"N/m +([\d.]+) mm", said)]
        self.assertEqual(len(lags_mm), 2, said)
        self.assertTrue(1.5 < lags_mm[0] / lags_mm[1] < 2.5, said)
        self.assertRegex(said, "4000 N/m   refused: .*not certified.*largest allowed k_pm_n_m")


if __name__ == "__main__":
    main()
