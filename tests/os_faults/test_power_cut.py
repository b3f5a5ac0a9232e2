"""Cuts the power of the program's disk: everything that the program reported as written must be there afterwards. The
disk is that of power_cut.py: it loses a random part of the writes since the last flush."""
import fcntl
import random
import re
import threading
import time

import faulty_disk  # noqa: F401  makes the following modules importable
import client
import power_cut
from app import ALWAYS, DONE, FULL, MOTION, SEED, main, read_recording
from test_sessions import RENDERING, RUN_STATE, TICK, Running
from test_sweep import GRID

CUTS = 200 if FULL else 20
MOST_BEHIND_S = 60.0  # largest age of the last tick in a recording or its inputs
CUTS_A_SESSION = 20
DISK_BYTES = 96 << 20
NAMES = 7
LAST_KEY = "wall_stiffness_ratio"  # last key of a profile: shows that the file is complete


class CutSession:
    """Profiles that a therapist saves during recorded sessions with power cuts, and the figures of the cuts."""

    def __init__(self, test):
        self.test, self.page = test, test.page
        self.asked = {f"p-{i}": [] for i in range(NAMES)}  # limits of each profile, in the order of the orders [N]
        self.accepted = {}      # profile -> index in `asked` of its last accepted save
        self.closed = None      # (name, bytes) of the recording of the session before
        self.behind_s = []      # for each cut: age of the last tick that can be read
        self.unreadable = 0     # cuts after which the recording itself has no readable tick
        self.ends = threading.Event()
        self.saving = threading.Thread(target=self._save, daemon=True)

    def start_saving(self):
        self.saving.start()
        self.test.addCleanup(self.ends.set)

    def finish_saving(self):
        self.ends.set()
        self.saving.join()

    def _save(self):
        """Sets a limit and saves a profile, again and again."""
        number = 0
        while not self.ends.is_set():
            name, limit_n = f"p-{number % NAMES}", 2.0 + number % 180 / 10  # 2 to 20 N are allowed
            number += 1
            if not self.page.answer(self.page.say(client.SET_PARAMETER, "effort_limit_arm_n", ("d", limit_n), ("I", self.page.basis())))[0]:
                # A cut copies the disk in this process: the page was silent for too long meanwhile.
                self.page.answer(self.page.say(client.TAKE_CONTROLS))
                continue
            self.asked[name].append(limit_n)
            if self.page.answer(self.page.say(client.SAVE_PROFILE, name))[0]:
                self.accepted[name] = len(self.asked[name]) - 1
            time.sleep(0.02)

    def cut_power(self, session):
        """Cuts the power during a session and checks what the disk has kept."""
        accepted, reported = dict(self.accepted), self.page.state.number(TICK, "Q")

        def check(left):
            self._check_profiles(left, accepted)
            self._check_recordings(left, session, reported)

        self.test.cut(check)

    def _check_profiles(self, left, accepted):
        for name, place in accepted.items():
            text = (left / f"out/profiles/{name}.toml").read_text()
            limit = re.search(r"effort_limit_arm_n = (\S+)", text)
            self.test.assertTrue(limit and LAST_KEY in text, f"{ALWAYS}{name} is not whole: {text!r}")
            self.test.assertIn(float(limit[1]), self.asked[name][place:],
                               f"{ALWAYS}{name}: what was acknowledged is lost")

    def _check_recordings(self, left, session, reported):
        if self.closed:
            name, whole = self.closed
            self.test.assertEqual((left / name).read_bytes(), whole, f"{ALWAYS}{name} is lost")
        ticks = self.test.ticks_in(left / f"{session}.h5")
        self.unreadable += ticks == 0
        rebuilt = self.test.ticks_in_inputs(left / f"{session}.inputs")
        self.behind_s.append(1e-3 * (reported - max(ticks, rebuilt)))


class PowerCut(Running):
    def setUp(self):
        super().setUp()
        try:
            power_cut.own_mounts()
            self.disk = power_cut.Disk(self.folder, DISK_BYTES)
        except OSError as error:
            print(f"not judged: {self.id()}: no disk whose power can be cut: {error}", flush=True)
            self.skipTest(str(error))
        self.kept, self.folder = self.folder, self.disk.files
        self.addCleanup(self.disk.remove)
        self.addCleanup(lambda: setattr(self, "folder", self.kept))
        self.draw = random.Random(SEED)

    def cut(self, check):
        """@param check called with the folder of the disk after the cut"""
        self.disk.cut(self.draw, self.kept / "after")
        with power_cut.Found(self.kept / "after", self.kept / "found") as left:
            check(left)

    def test_saved_profiles_and_recorded_sessions_survive_a_power_cut_slow(self):
        """A therapist repeatedly sets a limit and saves a profile while sessions are recorded; the power is cut at
        random moments."""
        run = self.start("--record", "run.h5", "--exercise", "cocktail-bar")
        fcntl.fcntl(run.stdout, fcntl.F_SETPIPE_SZ, 1 << 20)  # holds a line for each profile: it is read at the end
        cuts = CutSession(self)
        cuts.start_saving()
        for number in range(CUTS // CUTS_A_SESSION):
            session = "run" if number == 0 else f"run-{number + 1}"
            self.page.answer(self.page.say(client.TAKE_CONTROLS))
            accepted, reason = self.page.arm(self.endings)
            self.assertTrue(accepted, ALWAYS + reason)
            self.wait_until(run, lambda: self.page.state is not None
                            and self.page.state.number(RUN_STATE, "b") == RENDERING)
            for _ in range(CUTS_A_SESSION):
                time.sleep(0.3 * self.draw.random())
                cuts.cut_power(session)
            self.assertTrue(self.page.answer(self.page.say(client.EMERGENCY_STOP))[0])
            self.endings += 2
            self.page.wait_for_endings(self.endings)
            for old in self.folder.glob("run*"):
                if old.name != f"{session}.h5":
                    old.unlink()
            cuts.closed = (f"{session}.h5", (self.folder / f"{session}.h5").read_bytes())
        cuts.finish_saving()
        self.end(run)
        self.assertEqual(len(cuts.accepted), NAMES)
        behind_s = sorted(cuts.behind_s)
        saved = sum(map(len, cuts.asked.values()))
        print(f"figure: {len(behind_s)} power cuts, {saved} profiles, {self.disk.flushes} flushes: "
              f"recording or inputs are behind by {behind_s[len(behind_s) // 2]:.2f} s at the median, "
              f"{behind_s[-1]:.2f} s at most; {cuts.unreadable} recordings cannot be read, their inputs can",
              flush=True)
        self.assertLessEqual(behind_s[-1], MOST_BEHIND_S, ALWAYS)

    def ticks_in(self, recording):
        try:
            with read_recording(recording) as opened:
                return opened.rows()
        except (OSError, KeyError, ValueError):
            return 0  # HDF5 does not order its writes: then the inputs count

    def ticks_in_inputs(self, path):
        """Number of ticks that can be rebuilt from the inputs."""
        if not path.exists():
            return 0
        result = self.run_app("replay", path, "--extract", "again.h5", cwd=self.kept)
        reported = re.search(r": (\d+) ticks, made again", result.out)
        return int(reported[1]) if reported else 0

    def test_files_reported_as_written_survive_a_power_cut_slow(self):
        """Cuts the power after a command has ended: its recordings, summaries and sweep results must be there."""
        def check(left):
            for name, whole in said.items():
                kept = (left / name).is_file() and (left / name).read_bytes() == whole
                self.assertTrue(kept, f"{ALWAYS}{name} is lost")

        def keep(*names):
            for name in names:
                said[name] = (self.folder / name).read_bytes()
            for _ in range(CUTS // 10):
                self.cut(check)

        said = {}
        self.write("grid.toml", GRID)
        for number in range(5):
            self.expect(self.run_app("run", "--motion", MOTION, "--simulated-clock", "--duration", "0.3", "--record",
                                     f"{number}.h5", "--json", f"{number}.json"), DONE)
            keep(f"{number}.h5", f"{number}.json")
        self.expect(self.run_app("sweep", "grid.toml", "--out", "map.h5"), DONE)
        keep("map.h5")


if __name__ == "__main__":
    main()
