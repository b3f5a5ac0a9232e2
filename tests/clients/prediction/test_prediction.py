"""Compares predicted drawing of clients with the true hand positions: human motion recorded by the program, on a line
whose datagrams take 1 to 21 ms; 2 % are lost. The predictors of all clients get the same states.

test_prediction.py BUILD <folder to build in> [Class.test]. Without mono or godot3-server their tests are skipped."""
import json
import os
import pathlib
import re
import shutil
import subprocess
import sys
import unittest

os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")  # threads cost more time than these small matrices
import numpy  # noqa: E402

HERE = pathlib.Path(__file__).resolve().parent
SOURCE = HERE.parents[2]
FULL = os.environ.get("WHOLEHAND_FULL") == "1"
SEED = int(os.environ.get("WHOLEHAND_SEED", "1")) % 2**32
PERIOD_S = 0.001
BASE_S, JITTER_S, LOST = 0.001, 0.02, 0.02
STAMP_LATE_S = 0.002       # largest delay of a state's time stamp after its tick
CLOCK_DIFFERENCE_NS = 7_000_000_000_123  # offset of the client's clock
FRAME_S = 1 / 60
LARGEST_M = 0.002          # p99


class Recorded:
    """Joint positions of each tick, as the program played one human motion on its simulated clock."""

    def __init__(self, motion):
        file = WORK / f"{motion.stem}.h5"
        subprocess.run([PROGRAM, "run", "--motion", motion, "--simulated-clock", "--record", file], check=True,
                       stdin=subprocess.DEVNULL, stdout=subprocess.DEVNULL)
        with wholehand.open(file) as run:
            self.theta = run["ticks/theta"][:]
        file.unlink()

    def at(self, time_s):
        tick = time_s / PERIOD_S
        before = numpy.minimum(tick.astype(int), len(self.theta) - 2)
        share = (tick - before)[:, None]
        return (1 - share) * self.theta[before] + share * self.theta[before + 1]


class Run:
    """The states that reach a client, frame by frame, and the true position at each frame."""

    def __init__(self, recorded, rate_hz, draws, once_a_frame=False, polled=False):
        """@param once_a_frame only the newest state of each frame is used @param polled arrivals are noticed once per frame, half a frame late on average"""
        ticks = numpy.arange(0, len(recorded.theta), 1000 / rate_hz).astype(int)
        ticks = ticks[draws.random(len(ticks)) >= LOST]
        sent_s = ticks * PERIOD_S + draws.uniform(0, STAMP_LATE_S, len(ticks))
        received_s = sent_s + BASE_S + draws.uniform(0, JITTER_S, len(ticks))
        order = numpy.argsort(received_s, kind="stable")
        order = order[order >= numpy.maximum.accumulate(order)]  # a state that arrives after a newer one is dropped
        self.at_s = numpy.arange(0.3 + draws.uniform(0, FRAME_S), (len(recorded.theta) - 10) * PERIOD_S, FRAME_S)
        self.frames, next_state = [], 0
        for at_s in self.at_s:
            came = []
            while next_state < len(order) and received_s[order[next_state]] <= at_s:
                i = order[next_state]
                came.append([ticks[i] * PERIOD_S, int(1e9 * sent_s[i]), self.clock(at_s - 0.5 * FRAME_S if polled else received_s[i]),
                             recorded.theta[ticks[i]].tolist()])
                next_state += 1
            self.frames.append({"at_ns": self.clock(at_s), "states": came[-1:] if once_a_frame or polled else came})
        self.truth = recorded.at(self.at_s)

    @staticmethod
    def clock(time_s):
        return int(1e9 * time_s) + CLOCK_DIFFERENCE_NS


def by_python(runs):
    answers = []
    for run in runs:
        motion, joints = MotionPredictor(), []
        for frame in run.frames:
            for time_s, sent_ns, received_ns, theta in frame["states"]:
                motion.add_joints(1, time_s, sent_ns, received_ns, numpy.array(theta))
            joints.append(motion.joints(frame["at_ns"]))
        answers.append(numpy.array(joints))
    return answers


def by_newest(runs):
    """Without prediction: the newest state is drawn."""
    answers = []
    for run in runs:
        newest, joints = None, []
        for frame in run.frames:
            newest = frame["states"][-1][3] if frame["states"] else newest
            joints.append(newest)
        answers.append(numpy.array(joints))
    return answers


def by_command(command, runs, **environment):
    job, answer = WORK / "job.json", WORK / "answer.json"
    job.write_text(json.dumps({"runs": [run.frames for run in runs]}))
    answer.unlink(missing_ok=True)
    done = subprocess.run(command(job, answer), text=True, capture_output=True, timeout=250, env={
        **os.environ, **environment, "WHOLEHAND_JOB": str(job), "WHOLEHAND_ANSWER": str(answer)})
    if done.returncode != 0 or not answer.exists() or "ERROR" in done.stdout + done.stderr:
        raise AssertionError(f"{command(job, answer)[0]} ended with {done.returncode}:\n{done.stdout[-2000:]}{done.stderr[-2000:]}")
    return [numpy.array(joints) for joints in json.loads(answer.read_text())]


def setUpModule():
    global HAND, RUNS
    motions = sorted((SOURCE / "data/human-motion").glob("*.csv"))
    recorded = [Recorded(motion) for motion in (motions if FULL else motions[:12:4])]
    waiting = subprocess.Popen([PROGRAM, "run", "--port", "0", "--no-rehearsal", "--wait"], text=True, stdin=subprocess.DEVNULL,
                               stdout=subprocess.PIPE, stderr=subprocess.DEVNULL)
    try:
        with Client("127.0.0.1:" + re.search(r":(\d+)/", waiting.stdout.readline()).group(1)) as program:
            HAND = Hand(program.scene)
    finally:
        waiting.kill()
        waiting.communicate()
    draws = numpy.random.default_rng(SEED)
    RUNS = {"1000 states a second": [Run(r, 1000, draws) for r in recorded],
            "60 states a second": [Run(r, 60, draws) for r in recorded],
            "the newest of each frame": [Run(r, 1000, draws, once_a_frame=True) for r in recorded]}
    RUNS["60 a second, noticed by frames"] = [Run(r, 60, draws, polled=True) for r in recorded]


def furthest_m(runs, answers):
    """For every frame, the largest distance of a drawn link from its true position."""
    off = []
    for run, joints in zip(runs, answers):
        drawn, truth = (HAND.link_poses(theta)[..., :3, 3] for theta in (joints, run.truth))
        off.append(numpy.linalg.norm(drawn - truth, axis=-1).max(-1))
    return numpy.concatenate(off)


class Predicted(unittest.TestCase):
    def judge(self, client, predict):
        for name, runs in RUNS.items():
            answers = predict(runs)
            off, as_it_comes = furthest_m(runs, answers), furthest_m(runs, by_newest(runs))
            print(f"figure: {client}, {name}: links off by {1e3 * numpy.percentile(off, 99):.2f} mm at p99, {1e3 * off.max():.1f} mm "
                  f"at worst; drawn as states come {1e3 * numpy.percentile(as_it_comes, 99):.2f} mm at p99, {len(off)} frames")
            if "noticed by frames" not in name:  # there the age of a state is known only within a frame
                self.assertLessEqual(numpy.percentile(off, 99), LARGEST_M, name)
            self.assertGreater(numpy.percentile(as_it_comes, 99), LARGEST_M, f"{name}: there is nothing to predict")
            self.assertLess(numpy.percentile(off, 99), 0.7 * numpy.percentile(as_it_comes, 99), name)
            # The same as in Python within single precision, whose error the parabola enlarges.
            for answer, expected in zip(answers, by_python(runs)):
                self.assertLess(abs(answer - expected).max(), 2e-5, name)

    def test_python(self):
        self.judge("Python", by_python)

    @unittest.skipUnless(shutil.which("mcs") and shutil.which("mono"), "mono-mcs and mono-runtime are not installed")
    def test_csharp(self):
        library = WORK / "library"
        subprocess.run([SOURCE / "clients/csharp/build.sh", library], check=True, stdout=subprocess.DEVNULL)
        references = [f"-r:{library}/Wholehand.{name}.dll" for name in ("Protocol", "Client")]
        subprocess.run(["mcs", "-langversion:7", "-debug", "-nologo", "-warn:4", "-warnaserror", *references,
                        f"-out:{library}/Predict.exe", HERE / "Predict.cs", SOURCE / "tests/golden/csharp/Json.cs"], check=True)
        self.judge("C#", lambda runs: by_command(lambda job, answer: ["mono", "--debug", library / "Predict.exe", job, answer], runs))

    @unittest.skipUnless(shutil.which("godot3-server"), "godot3-server is not installed")
    def test_godot(self):
        project = WORK / "project"
        subprocess.run([sys.executable, "-B", SOURCE / "scripts/godot_addon.py", "make", project], check=True, stdout=subprocess.DEVNULL)
        shutil.copyfile(SOURCE / "tests/clients/godot/project.godot", project / "project.godot")
        shutil.copyfile(HERE / "predict.gd", project / "predict.gd")
        home = WORK / "home"
        (home / "godot/app_userdata/Tests of the Wholehand addon/logs").mkdir(parents=True, exist_ok=True)
        places = {name: str(home) for name in ("HOME", "XDG_DATA_HOME", "XDG_CONFIG_HOME", "XDG_CACHE_HOME")}
        self.judge("Godot", lambda runs: by_command(lambda *_: ["godot3-server", "--path", project, "-s", "res://predict.gd"], runs,
                                                    LANG="en_US.UTF-8", LC_ALL="en_US.UTF-8", **places))


class Ends(unittest.TestCase):
    """Limit cases in closed form, which a random line does not show."""

    def moving(self, speed, from_s=0.0, until_s=0.1, session=1, late_s=0.0):
        motion = self.motion
        for i in range(round(1000 * from_s), round(1000 * until_s) + 1):
            t = i * PERIOD_S
            motion.add_joints(session, t, int(1e9 * t), int(1e9 * (t + late_s)) + CLOCK_DIFFERENCE_NS, numpy.array([speed * t]))

    def setUp(self):
        self.motion = MotionPredictor()

    def at(self, time_s):
        return self.motion.joints(int(1e9 * time_s) + CLOCK_DIFFERENCE_NS)[0]

    def test_no_prediction_before_the_first_state(self):
        self.assertIsNone(self.motion.joints(0))
        self.moving(1.0, until_s=0.0)
        self.assertEqual(self.at(1.0), 0.0)

    def test_even_motion_is_extrapolated_for_50_ms_and_returns_after_100(self):
        self.moving(2.0)
        for ahead_s, expected in ((0.0, 0.2), (0.02, 0.24), (0.05, 0.3), (0.1, 0.3), (0.175, 0.25), (0.25, 0.2), (9.0, 0.2)):
            self.assertAlmostEqual(self.at(0.1 + ahead_s), expected, 6, f"{ahead_s} s ahead")

    def test_age_of_a_state_is_measured_from_the_fastest_delivery(self):
        self.moving(2.0, until_s=0.05)
        self.moving(2.0, from_s=0.051, until_s=0.1, late_s=0.03)  # slow states do not change the estimate
        self.assertAlmostEqual(self.at(0.13), 0.26, 6)

    def test_drifted_clock_is_corrected_after_4_s(self):
        self.moving(0.5, until_s=0.05)
        self.moving(0.5, from_s=0.051, until_s=5.0, late_s=0.03)
        self.assertAlmostEqual(self.at(5.03), 2.5, 6)

    def test_new_session_restarts_the_prediction(self):
        self.moving(2.0)
        self.moving(-1.0, from_s=0.05, until_s=0.05, session=2)
        self.assertAlmostEqual(self.at(0.06), -0.05, 6)

    def test_old_states_are_ignored(self):
        self.moving(2.0)
        self.moving(2.0, from_s=0.09, until_s=0.1)
        self.assertAlmostEqual(self.at(0.12), 0.24, 6)


if __name__ == "__main__":
    if len(sys.argv) < 3:
        sys.exit(__doc__)
    BUILD, WORK = pathlib.Path(sys.argv[1]).resolve(), pathlib.Path(sys.argv[2]).resolve()
    PROGRAM = BUILD / "wholehand"
    sys.path.insert(0, str(BUILD / "python"))
    import wholehand  # noqa: E402
    from wholehand.client import Client  # noqa: E402
    from wholehand.kinematics import Hand  # noqa: E402
    from wholehand.prediction import MotionPredictor  # noqa: E402
    WORK.mkdir(parents=True, exist_ok=True)
    unittest.main(argv=[sys.argv[0], *sys.argv[3:]])
