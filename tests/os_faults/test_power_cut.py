"""The power is cut while a program says what it has written: all of that is there afterwards. The disk is power_cut.py's:
what was not flushed is lost, a drawn part of it."""
import fcntl
import random
import re
import threading
import time

import faulty_disk  # noqa: F401  the way to what follows
import client
import power_cut
from app import ALWAYS, DONE, FULL, MOTION, SEED, main, read_recording
from test_sessions import RENDERING, RUN_STATE, TICK, Running
from test_sweep import GRID

CUTS = 200 if FULL else 20
MOST_BEHIND_S = 60.0  # of a recording, or of its inputs
CUTS_A_SESSION = 20
DISK_BYTES = 96 << 20
NAMES = 7
LAST_KEY = "wall_stiffness_ratio"  # of a profile


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
        """@param check of the folder of a disk after the cut"""
        self.disk.cut(self.draw, self.kept / "after")
        with power_cut.Found(self.kept / "after", self.kept / "found") as left:
            check(left)

    def test_profiles_that_were_saved_and_sessions_that_are_recorded_slow(self):
        """A therapist sets a limit and saves, again and again, while sessions are recorded; the power is cut at drawn
        moments of that."""
        run = self.start("--record", "run.h5", "--exercise", "cocktail-bar")
        fcntl.fcntl(run.stdout, fcntl.F_SETPIPE_SZ, 1 << 20)  # for a line of each profile: it is read at the end
        asked = {f"p-{i}": [] for i in range(NAMES)}  # limits in the order of asking [N]
        answered, ends = {}, threading.Event()        # name -> place in `asked` of the last that was accepted

        def save():
            number = 0
            while not ends.is_set():
                name, limit_n = f"p-{number % NAMES}", 2.0 + number % 180 / 10  # 2 to 20 N are allowed
                number += 1
                if not self.page.answer(self.page.say(client.SET_PARAMETER, "effort_limit_arm_n", ("d", limit_n)))[0]:
                    # A cut copies the disk in this process: the page was silent for too long meanwhile.
                    self.page.answer(self.page.say(client.TAKE_CONTROLS))
                    continue
                asked[name].append(limit_n)
                if self.page.answer(self.page.say(client.SAVE_PROFILE, name))[0]:
                    answered[name] = len(asked[name]) - 1
                time.sleep(0.02)

        def check(left):
            for name, place in before.items():
                text = (left / f"out/profiles/{name}.toml").read_text()
                limit = re.search(r"effort_limit_arm_n = (\S+)", text)
                self.assertTrue(limit and LAST_KEY in text, f"{ALWAYS}{name} is not whole: {text!r}")
                self.assertIn(float(limit[1]), asked[name][place:], f"{ALWAYS}{name}: what was acknowledged is lost")
            if closed:
                self.assertEqual((left / closed[0]).read_bytes(), closed[1], f"{ALWAYS}{closed[0]} is lost")
            ticks = self.ticks_in(left / f"{session}.h5")
            unread.append(ticks == 0)
            again = self.ticks_in_inputs(left / f"{session}.inputs")
            behind.append(1e-3 * (reported - max(ticks, again)))

        saving, behind, unread, closed = threading.Thread(target=save, daemon=True), [], [], None
        saving.start()
        self.addCleanup(ends.set)
        for number in range(CUTS // CUTS_A_SESSION):
            session = "run" if number == 0 else f"run-{number + 1}"
            self.page.answer(self.page.say(client.TAKE_CONTROLS))
            accepted, reason = self.page.arm(self.endings)
            self.assertTrue(accepted, ALWAYS + reason)
            self.wait_until(run, lambda: self.page.state is not None
                            and self.page.state.number(RUN_STATE, "b") == RENDERING)
            for _ in range(CUTS_A_SESSION):
                time.sleep(0.3 * self.draw.random())
                before, reported = dict(answered), self.page.state.number(TICK, "Q")
                self.cut(check)
            self.assertTrue(self.page.answer(self.page.say(client.EMERGENCY_STOP))[0])
            self.endings += 2
            self.page.wait_for_endings(self.endings)
            for old in self.folder.glob("run*"):
                if old.name != f"{session}.h5":
                    old.unlink()
            closed = (f"{session}.h5", (self.folder / f"{session}.h5").read_bytes())
        ends.set()
        saving.join()
        self.end(run)
        self.assertEqual(len(answered), NAMES)
        behind.sort()
        print(f"figure: {len(behind)} power cuts, {sum(map(len, asked.values()))} profiles, {self.disk.flushes} flushes: "
              f"recording or inputs are behind by {behind[len(behind) // 2]:.2f} s at the median, {behind[-1]:.2f} s at "
              f"most; {sum(unread)} recordings cannot be read, their inputs can", flush=True)
        self.assertLessEqual(behind[-1], MOST_BEHIND_S, ALWAYS)

    def ticks_in(self, recording):
        try:
            with read_recording(recording) as opened:
                return opened.rows()
        except (OSError, KeyError, ValueError):
            return 0  # HDF5 orders no write: the inputs count then

    def ticks_in_inputs(self, path):
        """How many ticks can be made again of them."""
        if not path.exists():
            return 0
        result = self.run_app("replay", path, "--extract", "again.h5", cwd=self.kept)
        reported = re.search(r": (\d+) ticks, made again", result.out)
        return int(reported[1]) if reported else 0

    def test_what_commands_said_to_be_written_slow(self):
        """Recordings that are closed, summaries, results of a sweep: a command ends, and then the power is cut."""
        def check(left):
            for name, whole in said.items():
                self.assertTrue((left / name).is_file() and (left / name).read_bytes() == whole, f"{ALWAYS}{name} is lost")

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
