"""wholehand.rig: the renderer inside Python. Same bits as the program, errors with reasons, arrays without copies."""
import copy
import os
import pickle
import subprocess
import sys
import tempfile
import threading
import time
import unittest
from pathlib import Path

import numpy
from app import BINARY, CONFIG, HANG_S, LAB, MOTION, SOURCE, AppTest, main

import wholehand
from wholehand.environment import ReachEnvironment, Reaching
from wholehand.rig import BadInput, Rig, RunEnded, VectorRig

sys.path.insert(0, str(SOURCE / "bench"))
import python_step  # noqa: E402

BUILD = BINARY.parent
STEPS = BUILD / "rig_steps"
FIELDS = ("q_m", "qd_mf", "intention", "patient_effort", "q_s", "qd_s", "theta", "f_s", "coupling", "phi", "damping",
          "rendered", "sent")
TICKS = 2500


def states(rig, ticks):
    """Values of every field after every tick."""
    rows = {name: [] for name in FIELDS}
    for _ in range(ticks):
        rig.step()
        for name in FIELDS:
            rows[name].append(getattr(rig, name).copy())
    return {name: numpy.array(values) for name, values in rows.items()}


def some_aims(rig, rows, seed):
    """Random aims over the whole ranges [m, rad], each held for one row."""
    return numpy.random.default_rng(seed).uniform(rig.lower, rig.upper, (rows, len(rig.lower)))


class SameBits(AppTest):
    def expect_as_recorded(self, rig, recording):
        got = states(rig, TICKS)
        with wholehand.open(recording) as run:
            for name in FIELDS:
                recorded = run[f"ticks/{name}"][:TICKS]
                ours = got[name].astype(recorded.dtype)
                tiny = numpy.abs(ours) < numpy.finfo(recorded.dtype).tiny  # the simulated clock flushes denormals
                ours[tiny] = numpy.copysign(0, ours[tiny])
                self.assertEqual(ours.tobytes(), recorded.tobytes(), name)

    def test_motion_is_bit_identical_to_the_program(self):
        recording = self.record("run.h5", "--motion", MOTION, duration=3)
        self.expect_as_recorded(Rig(motion=MOTION), recording)

    def test_exercise_with_a_seed_is_bit_identical_to_the_program(self):
        recording = self.record("run.h5", "--exercise", CONFIG / "exercises/cocktail-bar.toml", "--seed", 7, duration=3)
        rig = Rig(exercise="cocktail-bar", seed=1)
        rig.step(n=10)
        rig.reset(7)  # a reset must leave nothing of the earlier run
        self.expect_as_recorded(rig, recording)

    def test_every_engine_and_rate_is_bit_identical_to_the_program(self):
        for options in ([("--engine", "mujoco")] if LAB else []) + [("--rate-hz", 2000)]:
            with self.subTest(options):
                recording = self.record("run.h5", "--motion", MOTION, *options, duration=3)
                known = {"--engine": "engine", "--rate-hz": "rate_hz"}
                self.expect_as_recorded(Rig(motion=MOTION, **{known[options[0]]: options[1]}), recording)

    def test_steered_rig_is_bit_identical_to_a_session(self):
        rig = Rig()
        for ticks in (1, 7, 250):
            rig.reset()
            aims = some_aims(rig, 2000 // ticks, seed=ticks)
            aims.tofile(self.folder / "aims")
            subprocess.run([STEPS, "session", CONFIG, str(ticks), self.folder / "aims", self.folder / "out"], check=True)
            expected = numpy.fromfile(self.folder / "out").reshape(len(aims), -1)
            for aim, row in zip(aims, expected):
                self.assertEqual(rig.step(aim, ticks), ticks)
                self.assertEqual(numpy.concatenate([rig.q_m, rig.q_s, rig.sent]).tobytes(), row.tobytes())
            self.assertGreater(abs(expected[0] - expected[-1]).max(), 0.01, "it moved")

    def test_division_of_ticks_into_steps_changes_nothing(self):
        one, many = Rig(motion=MOTION), Rig(motion=MOTION)
        one.step(n=3000)  # long enough for several checks of Ctrl-C
        for n in (1, 999, 2000):
            many.step(n=n)
        self.assertEqual(one.tick, 2999)
        self.assertEqual(one.theta.tobytes(), many.theta.tobytes())


class Arrays(unittest.TestCase):
    def test_arrays_are_views_of_the_rig(self):
        rig = Rig()
        before, copied = rig.q_s, rig.q_s.copy()
        rig.step(rig.upper, 100)
        self.assertTrue(numpy.shares_memory(before, rig.q_s))
        self.assertTrue((before == rig.q_s).all())
        self.assertTrue((before != copied).any())
        with self.assertRaisesRegex(ValueError, "read-only"):
            rig.q_s[0] = 1.0
        views, kept = rig.q_s, rig.q_s.copy()
        del rig
        self.assertTrue((views == kept).all())  # the array keeps the rig's memory alive

    def test_what_is_one_number_is_kept_as_it_was(self):
        rig = Rig()
        ticks, times = [], []
        for _ in range(5):
            rig.step(n=20)
            ticks.append(rig.tick)
            times.append(rig.time_s)
        self.assertEqual(ticks, [19, 39, 59, 79, 99])
        for time_s, tick in zip(times, ticks):
            self.assertAlmostEqual(time_s, 1e-3 * tick, 12)
        for name in dir(rig):
            if name.startswith("_"):
                continue
            value = getattr(rig, name)
            self.assertFalse(isinstance(value, numpy.ndarray) and value.ndim == 0, f"{name} is a view of one number")

    def test_touched_body_has_contacts_with_forces(self):
        rig = Rig(motion=MOTION)
        for _ in range(600):
            rig.step(n=10)
            if rig.contact_count > 0:
                break
        self.assertEqual(len(rig.contacts), rig.contact_count)
        contact = rig.contacts[0]
        self.assertAlmostEqual(float(numpy.linalg.norm(contact["normal"])), 1.0, 12)
        self.assertIn(contact["body"], range(len(rig.body_names)))
        self.assertGreaterEqual(float(contact["force_n"] @ contact["normal"]), -1e-12, "contacts never pull")
        self.assertEqual(len(rig.bodies), len(rig.body_names))
        numpy.testing.assert_allclose(numpy.linalg.norm(rig.bodies["orientation_xyzw"], axis=1), 1.0, atol=1e-12)

    def test_hand_before_the_first_step_is_where_it_was_armed(self):
        rig = Rig(exercise="cocktail-bar")
        start = rig.q_m.copy()
        self.assertTrue((rig.q_s == start).all())
        self.assertEqual(len(rig.theta), len(rig.joint_names))
        self.assertEqual(len(rig.exercise_values), len(rig.value_names))
        self.assertTrue((rig.sent == 0.0).all())
        rig.step(n=50)
        rig.reset()
        self.assertTrue((rig.q_m == start).all())


class Steps(AppTest):
    def test_aim_moves_the_hand_and_without_aim_the_patient_does(self):
        rig = Rig(scene="empty")
        rest = rig.q_s.copy()
        aim = rest + (0.02, 0, 0, 0, 0, 0)
        rig.step(aim, 1500)
        self.assertLess(abs(rig.intention - aim).max(), 1e-6)
        self.assertLess(abs(rig.q_s[0] - aim[0]), 0.004)  # dry friction against the person's spring of 300 N/m
        rig.step(n=3000)
        self.assertLess(abs(rig.intention - rest).max(), 1e-4)

    def test_other_threads_run_during_a_step(self):
        rig, seen, done = Rig(), [], threading.Event()

        def work():
            rig.step(n=30_000)
            done.set()
        thread = threading.Thread(target=work)
        thread.start()
        while not done.is_set():
            seen.append(done.is_set())
            if len(seen) == 1:
                with self.assertRaisesRegex(RuntimeError, "another thread"):
                    while not done.is_set():
                        rig.step()
            time.sleep(1e-3)
        thread.join()
        self.assertGreater(len(seen), 20)

    def test_fault_ends_the_run_until_a_reset(self):
        slams = (CONFIG / "patients/slams.toml").read_text()
        slams = self.write("slams-harder.toml", slams.replace("speed_share = 0.98", "speed_share = 1.5"))
        rig = Rig(patient=slams, scene="empty")
        ran = rig.step(n=60_000)
        self.assertFalse(rig.running)
        self.assertLess(ran, 60_000)
        self.assertIn("speed limit exceeded", rig.ended_by)
        with self.assertRaisesRegex(RunEnded, rf"the run ended at [\d.]+ s: .*{rig.ended_by}; reset\(\) begins anew"):
            rig.step()
        rig.reset()
        self.assertEqual(rig.step(n=5), 5)


def bits(rig):
    """The bytes of all public values of a rig."""
    return b"".join(numpy.asarray(getattr(rig, name)).tobytes() for name in (*FIELDS, "tick", "bodies", "contacts", "exercise_values"))


class Saved(unittest.TestCase):
    """Compares a restored rig with the same rig that continued."""

    def played(self, **options):
        """A rig in the middle of a run with and without aims."""
        rig = Rig(**options)
        rig.step(n=700)
        for aim in some_aims(rig, 5, seed=8):
            rig.step(rig.q_s + 0.1 * (aim - rig.q_s), 60)
        rig.step(n=200)
        rig.step(n=100)
        return rig

    def expect_same_from_here(self, one, other):
        self.assertEqual(bits(one), bits(other))
        for aim in some_aims(one, 3, seed=9):
            for rig in (one, other):
                rig.step(aim, 40)
                rig.step(n=3)
            self.assertEqual(bits(one), bits(other))

    def test_restored_state_is_and_continues_bit_identical(self):
        for options in ({}, {"exercise": "cocktail-bar", "seed": 3}):
            rig = self.played(**options)
            state, there = rig.save(), bits(rig)
            rig.step(n=500)
            self.assertNotEqual(bits(rig), there)
            other = Rig(**{**options, "seed": 99})
            rig.restore(state)
            other.restore(state)
            self.assertEqual(bits(rig), there)
            self.expect_same_from_here(rig, other)
            self.assertEqual(rig.save(), other.save())

    def test_rig_can_be_pickled_and_copied(self):
        rig = self.played()
        said = subprocess.run([sys.executable, "-c", "import sys, pickle; rig = pickle.load(sys.stdin.buffer); rig.step(n=25); "
                               "sys.stdout.buffer.write(rig.q_s.tobytes() + rig.theta.tobytes())"], input=pickle.dumps(rig),
                              stdout=subprocess.PIPE, check=True, env={**os.environ, "PYTHONPATH": str(BUILD / "python")},
                              cwd=os.getcwd())
        other = copy.deepcopy(rig)
        self.expect_same_from_here(other, copy.copy(rig))
        rig.step(n=25)
        self.assertEqual(said.stdout, rig.q_s.tobytes() + rig.theta.tobytes())

    def test_foreign_or_damaged_state_is_refused(self):
        rig = self.played()
        state = rig.save()
        for damaged in (b"", state[:-1], state + b"0", state[:60] + bytes([state[60] ^ 1]) + state[61:]):
            with self.assertRaisesRegex(ValueError, "damaged, or none that"):
                rig.restore(damaged)
        self.assertEqual(rig.save(), state, "a refusal changes nothing")
        with self.assertRaisesRegex(ValueError, r"saved with other files or by another program: tick \d+ differs"):
            Rig(scene="empty").restore(state)
        with self.assertRaisesRegex(ValueError, "other axes"):
            Rig("desktop-3axis", scene="empty").restore(state)

    def test_closed_rig_does_not_run_until_a_reset(self):
        with Rig(scene="empty") as rig:
            rig.step(n=10)
            self.assertRegex(repr(rig), r"<Rig device=lambda-pride, .*scene=empty, .*: 0\.009 s, runs>")
        last = rig.q_s.copy()
        self.assertFalse(rig.running)
        self.assertIn("closed", repr(rig))
        for ended in (rig.step, rig.save):
            with self.assertRaisesRegex(RunEnded, r"reset\(\) begins anew"):
                ended()
        self.assertEqual(rig.q_s.tobytes(), last.tobytes())
        rig.close()
        rig.reset()
        self.assertEqual(rig.step(n=5), 5)

    def test_scene_of_rig_alone_can_be_named(self):
        one, other = Rig(), Rig(scene="four-shapes")
        for rig in (one, other):
            rig.step(n=300)
        self.assertEqual(bits(one), bits(other))


class Readme(unittest.TestCase):
    def test_code_of_the_readme_runs_unchanged(self):
        text = (SOURCE / "clients/python/README.md").read_text().split("## Rigs inside Python\n")[1]
        names = {}
        exec(text.split("```python\n")[1].split("```")[0], names)  # noqa: S102
        self.assertEqual(float(names["rig"].time_s), 0.0, "it ends with a reset")


class BadInputs(unittest.TestCase):
    def test_bad_aim_is_refused_by_name(self):
        rig = Rig()
        good = rig.q_s.copy()
        for aim, error, why in ((good[:5], ValueError, r"aim has the shape \(5,\); must be \(6,\), an axis each: x, y, z"),
                                ([good], ValueError, r"shape \(1, 6\); must be \(6,\)"),
                                (numpy.nan * good, ValueError, r"aim\[0\] \(x\) = -?nan: is not finite"),
                                ([0, 0, 0, 0, 0, numpy.inf], ValueError, r"aim\[5\] \(thumb_flexion\) = inf: is not finite"),
                                (numpy.ma.array(good, mask=[0, 1, 0, 0, 0, 0]), ValueError, "aim has masked values"),
                                ("up", TypeError, "aim = 'up': is not an array of numbers")):
            with self.assertRaisesRegex(error, why):
                rig.step(aim)
        for n in (0, -3, 5.0, "5"):
            with self.assertRaisesRegex(ValueError, rf"n = {n!r}: must be a whole number >= 1"):
                rig.step(good, n)
        self.assertEqual(rig.step(good.tolist(), 2), 2, "a refusal changes nothing")
        self.assertEqual(Rig().step(numpy.ma.array(good, mask=False)), 1, "nothing is masked")
        self.assertEqual(rig.tick, 1)
        for seed, allowed in ((-1, ">= 0"), (2.5, ">= 0"), (2**64, r"in \[0, 18446744073709551615\]")):
            with self.assertRaisesRegex(ValueError, rf"^seed = {seed}: must be a whole number {allowed}$"):
                Rig(seed=seed)
            with self.assertRaisesRegex(ValueError, rf"^seed = {seed}: must be a whole number {allowed}$"):
                rig.reset(seed)

    def test_arguments_of_wrong_types_are_refused_by_name(self):
        """pybind11 alone would answer with the signature of the constructor."""
        rig, rigs = Rig(scene="empty"), VectorRig(2, threads=1, scene="empty")
        wrong = (1.5, -1, float("nan"), 2**70, numpy.float64(2.0), b"\xff", object(), 1j, [1], "\0", "a" * 300)
        refused = (ValueError, TypeError, IndexError)
        calls = {"seed": lambda v: rig.reset(v), "n": lambda v: rig.step(n=v), "aim": lambda v: rig.step(v),
                 "seeds": lambda v: rigs.reset(v), "rig": lambda v: rigs.reset_one(v), "state": lambda v: rig.restore(v),
                 "threads": lambda v: VectorRig(2, threads=v, scene="empty")}
        for key in ("level", "engine", "rate_hz", "uncertified", "device", "hand", "scene", "patient", "exercise", "rendering",
                    "motion"):
            calls[key] = lambda v, key=key: Rig(**{key: v})
        for key, call in calls.items():
            for value in wrong:
                with self.subTest(key=key, value=repr(value)[:40]), self.assertRaises(refused) as why:
                    call(value)
                for dump in ("incompatible", "Invoked with", "arg0"):
                    self.assertNotIn(dump, str(why.exception))
                if not isinstance(why.exception, BadInput):
                    self.assertIn(key if key != "state" else "the state", str(why.exception).replace("state =", "the state"))
        for call in (lambda: rig.step(m=5), lambda: rig.reset(1, 2), lambda: rigs.reset_one(), lambda: Rig(sead=1)):
            with self.assertRaisesRegex(TypeError, r"^(Vector)?Rig\.\w+\(\) "):
                call()
        for key in ("device", "hand", "patient"):
            with self.assertRaisesRegex(ValueError, f"^{key} = '': must be a path"):
                Rig(**{key: ""})

    def test_bad_files_are_refused_with_the_programs_messages(self):
        with self.assertRaisesRegex(BadInput, "no-such.toml") as refused:
            Rig("/no-such.toml")
        self.assertTrue(any(d["file"] == "/no-such.toml" and d["problem"] for d in refused.exception.diagnostics))
        for key in ("hand", "scene", "patient", "exercise", "motion", "rendering"):
            with self.assertRaisesRegex(BadInput, "no-such"):
                Rig(**{key: "no-such"})
        with self.assertRaisesRegex(BadInput, "^engine = no-such: is not a known engine; use bullet"):
            Rig(engine="no-such")
        with self.assertRaisesRegex(ValueError, "rate_hz = 5.*must be in"):
            Rig(rate_hz=5)
        with self.assertRaisesRegex(ValueError, "exercise = 'cocktail-bar': cannot go with scene or motion"):
            Rig(exercise="cocktail-bar", scene="table")
        with self.assertRaises(BadInput) as both:
            Rig(scene="/no-scene.toml", hand="/no-hand.toml")
        self.assertLessEqual({"/no-scene.toml", "/no-hand.toml"}, {d["file"] for d in both.exception.diagnostics})

    def test_ignored_parts_of_a_file_are_warnings(self):
        with tempfile.TemporaryDirectory() as folder:
            scene = Path(folder, "thing.toml")
            Path(folder, "thing.urdf").write_text(
                '<robot name="r"><link name="a"><collision><geometry><sphere radius="0.02"/></geometry><surface>'
                '<friction><ode><mu>0.1</mu></ode></friction></surface></collision></link></robot>')
            scene.write_text('kind = "scene"\nversion = 1\nname = "s"\ngravity_m_s2 = [0, 0, 0]\n[[bodies]]\n'
                             'name = "t"\nshape = "urdf"\nfile = "thing.urdf"\nposition_m = [0.5, 0, 0]\n'
                             'mass_kg = 0.1\n')
            with self.assertWarnsRegex(UserWarning, "thing.urdf:1: mu = 0.1: is friction where none is read") as told:
                Rig(scene=str(scene))
            self.assertEqual(told.filename, __file__)


class Vectors(unittest.TestCase):
    def test_each_rig_equals_a_single_rig_on_any_number_of_threads(self):
        aims = some_aims(Rig(), 40, seed=3).reshape(10, 4, 6)
        alone = []
        for i in range(4):
            rig = Rig(exercise="cocktail-bar", seed=20 + i)
            rig.step(n=5)
            for aim in aims:
                if rig.running:
                    rig.step(aim[i], 37)
            alone.append((rig.theta.tobytes(), rig.sent.tobytes(), rig.exercise_values.tobytes()))
        for threads in (1, 3):
            rigs = VectorRig(4, threads=threads, exercise="cocktail-bar", seed=20)
            self.assertEqual(rigs.threads, threads)
            rigs.step(n=5)
            for aim in aims:
                rigs.step(aim, 37)
            self.assertEqual(rigs.q_s.shape, (4, 6))
            self.assertEqual([(rigs.theta[i].tobytes(), rigs.sent[i].tobytes(), rigs.exercise_values[i].tobytes())
                              for i in range(4)], alone)

    def test_one_rig_is_reset_while_the_others_continue(self):
        rigs = VectorRig(3, threads=2)
        self.assertEqual((len(rigs), rigs.tick.tolist()), (3, [0, 0, 0]))
        rigs.step(n=10)
        rigs.reset_one(1)
        rigs.step(n=5)
        self.assertEqual(rigs.tick.tolist(), [14, 4, 14])
        self.assertTrue(rigs.running.all())
        self.assertEqual(rigs.contacts.shape[0], 3)

    def test_bad_input_names_the_rig(self):
        rigs = VectorRig(2, threads=2)
        aims = rigs.q_s.copy()
        aims[1, 2] = numpy.nan
        with self.assertRaisesRegex(ValueError, r"aim\[1, 2\] \(z\) = -?nan: is not finite"):
            rigs.step(aims)
        with self.assertRaisesRegex(ValueError, r"shape \(6,\); must be \(2, 6\)"):
            rigs.step(aims[0])
        with self.assertRaisesRegex(ValueError, "seeds has 3 numbers; must have one for each of 2 rigs"):
            rigs.reset([1, 2, 3])
        with self.assertRaisesRegex(IndexError, r"rig = 2: must be in 0 \.\. 1"):
            rigs.reset_one(2)
        for bad in ({"n": 0}, {"n": 2, "threads": 0}):
            with self.assertRaisesRegex(ValueError, "= 0: must be a whole number >= 1"):
                VectorRig(**bad)


def played(environment, seed, draws_seed=5):
    """All values that an episode of random actions returns, as numbers."""
    draws = numpy.random.default_rng(draws_seed)
    observation, info = environment.reset(seed=seed)
    said = [*observation, *info["target_m"]]
    over = False
    while not over:
        observation, reward, terminated, truncated, info = environment.step(draws.uniform(-1, 1, 3))
        said += [*observation, reward, terminated, truncated, info["distance_m"]]
        over = terminated or truncated
    return numpy.array(said)


class Environment(unittest.TestCase):
    """Checks the rules of gymnasium's API (gymnasium.utils.env_checker) without gymnasium."""

    @classmethod
    def setUpClass(cls):
        cls.environment = ReachEnvironment()

    def test_observations_and_actions_are_in_their_spaces(self):
        environment = self.environment
        for space, shape in ((environment.action_space, (3,)), (environment.observation_space, (9,))):
            self.assertEqual((space.shape, space.low.shape, space.high.shape), (shape,) * 3)
            space.seed(3)
            first = space.sample()
            space.seed(3)
            self.assertEqual(first.tobytes(), space.sample().tobytes())
            self.assertTrue(space.contains(first))
            self.assertEqual(first.dtype, space.dtype)
        self.assertFalse(environment.action_space.contains(numpy.array([0.0, 0.0, 1.1])))
        self.assertFalse(environment.action_space.contains(numpy.zeros(2)))
        observation, info = environment.reset(seed=1)
        self.assertTrue(environment.observation_space.contains(observation))
        self.assertIsInstance(info, dict)
        for _ in range(5):
            result = environment.step(environment.action_space.sample())
            self.assertEqual(len(result), 5)
            observation, reward, terminated, truncated, info = result
            self.assertTrue(environment.observation_space.contains(observation))
            self.assertEqual([type(x) for x in (reward, terminated, truncated, info)], [float, bool, bool, dict])
        self.assertIs(environment.unwrapped, environment)

    def test_same_seed_is_bit_identical_and_another_is_not(self):
        one = played(self.environment, seed=11)
        self.assertEqual(one.tobytes(), played(self.environment, seed=11).tobytes())
        self.assertEqual(one.tobytes(), played(ReachEnvironment(), seed=11).tobytes())
        self.assertNotEqual(one[9:12].tolist(), played(self.environment, seed=12)[9:12].tolist())
        targets = []
        for seed in (7, None, None, 7, None):  # without a seed the random sequence continues
            targets.append(self.environment.reset(seed=seed)[1]["target_m"].tolist())
        self.assertEqual(targets[0], targets[3])
        self.assertEqual(targets[1], targets[4])
        self.assertEqual(len({tuple(target) for target in targets[:3]}), 3)

    def test_resting_hand_is_truncated_after_two_seconds(self):
        environment = self.environment
        environment.reset(seed=1)
        self.assertGreater(environment._info()["distance_m"], 0.02)
        for step in range(1, 101):
            _, reward, terminated, truncated, info = environment.step(numpy.zeros(3))
            self.assertEqual((terminated, truncated), (False, step == 100))
        self.assertAlmostEqual(environment.rig.time_s + 1e-3, 2.0)
        self.assertAlmostEqual(reward, -10.0 * info["distance_m"])
        with self.assertRaisesRegex(RuntimeError, r"call reset\(\) first"):
            environment.step(numpy.zeros(3))

    def test_hand_at_the_target_terminates_the_episode(self):
        for seed in range(5):
            environment = self.environment
            observation, info = environment.reset(seed=seed)
            terminated = truncated = False
            while not (terminated or truncated):  # observations 3 to 5: distance of the aim in 0.1 m
                action = numpy.clip(0.1 * observation[3:6] / Reaching.MOST_M, -1.0, 1.0)
                observation, reward, terminated, truncated, info = environment.step(action)
            self.assertEqual((terminated, truncated, info["reached"], reward), (True, False, True, 0.0))
            self.assertLess(info["distance_m"], Reaching.NEAR_M)

    def test_bad_actions_and_devices_are_named(self):
        environment = ReachEnvironment()
        with self.assertRaisesRegex(RuntimeError, r"call reset\(\) first"):
            environment.step(numpy.zeros(3))
        environment.reset(seed=0)
        for bad in ([0.0, 0.0], [0.0, 0.0, numpy.nan]):
            with self.assertRaisesRegex(ValueError, "action = .*must be 3 finite numbers"):
                environment.step(bad)
        self.assertEqual(ReachEnvironment(Rig("desktop-3axis", scene="empty")).reset(seed=2)[0].shape, (9,))


class Types(unittest.TestCase):
    def check(self, *command):
        package = BUILD / "python"
        done = subprocess.run(command, capture_output=True, text=True, cwd=package,
                              env={**os.environ, "PYTHONPATH": str(package), "MYPYPATH": str(package),
                                   "MYPY_CACHE_DIR": os.devnull})
        self.assertEqual(done.returncode, 0, done.stdout + done.stderr)

    def test_mypy_accepts_the_types(self):
        self.check("/usr/bin/mypy", "--config-file", SOURCE / "clients/python/mypy.ini", "--python-executable", sys.executable,
                   *(f"wholehand/{module.name}" for module in sorted((BUILD / "python/wholehand").glob("*.py"))))

    def test_stubs_match_the_module(self):
        self.check("/usr/bin/stubtest", "--mypy-config-file", SOURCE / "clients/python/mypy.ini", "--allowlist",
                   SOURCE / "clients/python/stubtest_allowlist.txt", "wholehand._rig")


class Cost(unittest.TestCase):
    paced = True

    def test_ten_ticks_a_step_cost_at_most_a_tenth_more_than_in_cpp_slow(self):
        share = python_step.over(python_step.measure(BUILD, ticks=10, rounds=15))
        print(f"a step of 10 ticks costs {100 * share:+.1f} % over C++", flush=True)
        self.assertLessEqual(share, 0.10)


if __name__ == "__main__":
    main()
