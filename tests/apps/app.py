"""Common parts of the end-to-end tests: running the real program in a temporary folder."""
import json
import os
import pathlib
import random
import re
import resource
import shutil
import subprocess
import sys
import tempfile
import time
import unittest

SOURCE = pathlib.Path(__file__).resolve().parents[2]
sys.path.insert(0, str(SOURCE / "tests/support"))
from watched_main import ALWAYS, FULL, HANG_S, main  # noqa: E402, F401  imported by the tests from here
BINARY = pathlib.Path(os.environ.get("WHOLEHAND_BINARY", SOURCE / "build/release/wholehand")).resolve()
sys.path.insert(0, str(BINARY.parent / "python"))  # the built package, with flatc's code
from wholehand.recording import Recording  # noqa: E402

LAB = os.environ.get("WHOLEHAND_LAB") == "1"  # the program includes lab/
SEED = int(os.environ.get("WHOLEHAND_SEED", "1"))
CONFIG = SOURCE / "config"
MOTION = SOURCE / "data/human-motion/reach-grasp-00.csv"

# `run` without options opens the bar; with a motion it grasps freely and ends by itself.
FREE_RUN = ("run", "--motion", MOTION)

DONE, DIFFERENT, BAD_INPUT, FAULT, INTERRUPTED = 0, 1, 2, 3, 130
NOT_WHOLE = 1  # exit code of replay and report: a part of the recording is not shown
STOP_REQUESTED = 1 << 10  # docs/recording.md, bits of `faults`


class Result:
    def __init__(self, done):
        self.code, self.out, self.err = done.returncode, done.stdout, done.stderr

    def __str__(self):
        return f"exit code {self.code}\n--- standard output\n{self.out}--- standard error\n{self.err}"


def said(*command, **how):
    """Runs a command that must succeed and returns its output."""
    done = subprocess.run([*map(str, command)], capture_output=True, text=True, **how)
    if done.returncode != 0:
        raise AssertionError(f"{' '.join(map(str, command))} ended with {done.returncode}:\n{done.stdout}{done.stderr}")
    return done.stdout


class AppTest(unittest.TestCase):
    """A test with an empty folder `self.folder`, in which the program runs."""

    @classmethod
    def setUpClass(cls):
        # Random numbers for the tests, from the seed that ./check prints.
        cls.random = random.Random(SEED)

    def setUp(self):
        self.folder = pathlib.Path(tempfile.mkdtemp(prefix="wholehand-test-"))
        self.addCleanup(shutil.rmtree, self.folder, ignore_errors=True)

    def run_app(self, *arguments, timeout=HANG_S, binary=BINARY, cwd=None, **how):
        command = [str(binary), *map(str, arguments)]
        return Result(subprocess.run(command, cwd=cwd or self.folder, timeout=timeout, text=True, errors="replace",
                                     stdin=subprocess.DEVNULL, capture_output=True, **how))

    @staticmethod
    def copy_programs(folder):
        """Copies the program and wholehand-tools into a folder; returns the program's copy."""
        folder.mkdir(parents=True, exist_ok=True)
        for name in ("wholehand", "wholehand-tools"):
            shutil.copy(BINARY.with_name(name), folder)
        return folder / "wholehand"

    def start_app(self, *arguments, **how):
        """Starts the program in the background; it is killed at the end of the test at the latest."""
        process = subprocess.Popen([str(BINARY), *map(str, arguments)], cwd=self.folder, text=True,
                                   stdin=subprocess.DEVNULL, stdout=subprocess.PIPE,
                                   stderr=subprocess.PIPE, **how)
        self.addCleanup(process.communicate)
        self.addCleanup(process.kill)
        return process

    def wait_until(self, run, what, say=lambda: ""):
        """Waits until `what` is true, or the program in the background has ended."""
        until = time.monotonic() + HANG_S
        while run.poll() is None and not what():
            self.assertLess(time.monotonic(), until, f"{ALWAYS}it hangs\n{say()}")
            time.sleep(0.01)

    def wait_until_it_catches(self, run, number):
        """Waits until the program has a handler for the signal."""
        status = pathlib.Path(f"/proc/{run.pid}/status")
        self.wait_until(run, lambda: int(status.read_text().split("SigCgt:")[1].split()[0], 16)
                        >> (number - 1) & 1 == 1)

    def wait_until_it_renders(self, run):
        """Waits until the loop's thread has slept before some hundred ticks. Its CPU time is no measure: it
        includes locking memory."""
        self.wait_until(run, lambda: loop_sleeps(run.pid) >= 100)

    def expect_ended_by(self, run, number, code=INTERRUPTED):
        """Sends the signal, expects this exit code and returns the program's output."""
        run.send_signal(number)
        said, complained = run.communicate(timeout=HANG_S)
        self.assertEqual(run.returncode, code, said + complained)
        return said

    def expect(self, result, code, *texts):
        self.assertEqual(result.code, code, result)
        for text in texts:
            self.assertIn(text, result.out + result.err, result)
        return result

    def expect_refused(self, result, *texts, lines=None):
        """Expects exit code 2 and the reason with these texts on standard error, without any text of a crash."""
        self.expect(result, BAD_INPUT)
        for text in texts:
            self.assertIn(text, result.err, result)
        for word in ("terminate called", "what():", "HDF5-DIAG", "Assertion", "Segmentation"):
            self.assertNotIn(word, result.out + result.err, result)
        if lines is not None:
            self.assertEqual(len(result.err.splitlines()), lines, result)
        return result

    def write(self, name, text):
        path = self.folder / name
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_bytes(text if isinstance(text, bytes) else text.encode())
        return path

    def record(self, name="run.h5", *arguments, duration=1.5, code=DONE, simulated=True):
        clock = ["--simulated-clock"] if simulated else []
        run = ("run",) if {"--motion", "--exercise", "--level"} & set(arguments) else FREE_RUN
        self.expect(self.run_app(*run, *clock, "--duration", duration, "--record", name, *arguments),
                    code)
        return self.folder / name

    def expect_same_when_run_again(self, recording):
        return self.expect(self.run_app("replay", "--resimulate", recording), DONE,
                           "every bit the same")

    def names_in(self, folder):
        return sorted(str(p.relative_to(folder)) for p in pathlib.Path(folder).rglob("*"))


class PacedTest(AppTest):
    """A test that depends on real time: drives' watchdogs, hosts, held keys (watched_main.py)."""

    paced = True


def loop_sleeps(pid):
    """How often the loop's thread of a program has slept, which is once before each tick."""
    for status in pathlib.Path(f"/proc/{pid}/task").glob("*/status"):
        text = status.read_text()
        if text.startswith("Name:\twholehand-loop"):
            return int(text.split("\nvoluntary_ctxt_switches:")[1].split()[0])
    return 0


def lose_ticks(path, begin, end):
    """Changes these ticks of a recording to ticks that never reached the disk; returns its number of rows."""
    import h5py
    import numpy
    never = -1  # docs/recording.md
    with h5py.File(path, "r+", libver="latest") as f:
        f["ticks/tick"][begin:end] = never
        f["ticks/contact_count"][begin:end] = 0
        rows = f["contacts/row"][:]
        rows[(rows >= begin) & (rows < end)] = never
        f["contacts/row"][:] = rows
        return len(f["ticks/tick"])


def corrupt_chunk(path, dataset, number):
    """Inverts the bytes of a chunk of a recording, from the last one if negative; returns its first row."""
    import h5py
    with h5py.File(path, "r") as f:
        chunks = f[dataset].id
        chunk = chunks.get_chunk_info(number % chunks.get_num_chunks())
    whole = bytearray(path.read_bytes())
    for at in range(chunk.byte_offset, chunk.byte_offset + chunk.size):
        whole[at] ^= 0xFF
    path.write_bytes(whole)
    return chunk.chunk_offset[0]


def read_recording(path):
    """Opens a recording as docs/recording.md describes."""
    return Recording(path)


def report_data(page):
    """The data of a one-file page, which it contains once."""
    data, = re.findall(r'<script type="application/json" id="page-data">(.*?)</script>', page.read_text(), re.S)
    return json.loads(data)


def sentences_of(data):
    """The sentences of a page of charts by their names, with their placeholders."""
    if isinstance(data, list):
        return {name: places for part in data for name, places in sentences_of(part).items()}
    if not isinstance(data, dict):
        return {}
    if "sentence" in data:
        return {data["sentence"]: set(data["with"])}
    return sentences_of(list(data.values()))


def expect_known_sentences(test, page):
    """Expects every sentence of a page of charts in the texts of web/src/charts, with the same placeholders."""
    known = {name or plain: set(re.findall(r"\{(\w+)\}", text)) for name, plain, text in re.findall(
        r"(?:'([\w.]+)'|\b(\w+)): '([^']*)'", (SOURCE / "web/src/charts/i18n/en.ts").read_text())}
    for name, places in sentences_of(page).items():
        test.assertIn(name, known)
        test.assertEqual(places, known[name], name)


def limit_file_size(size_bytes):
    """For preexec_fn: limits the size of the program's files, as a full disk would."""
    return lambda: resource.setrlimit(resource.RLIMIT_FSIZE, (size_bytes, size_bytes))


def ordinary_user():
    """Options with which subprocess runs a program as an ordinary user: root becomes nobody."""
    if os.geteuid() != 0:
        return {}
    return {"user": 65534, "group": 65534, "extra_groups": []}
