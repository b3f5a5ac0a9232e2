"""`wholehand sweep`: every cell is run once, by any process, with bit-identical results."""
import hashlib
import json
import os
import re
import shutil
import signal
import struct
import subprocess
import time
import unittest

import h5py

from app import BAD_INPUT, BINARY, CONFIG, DONE, FAULT, FULL, HANG_S, INTERRUPTED, LAB, AppTest, Result, main

GRID = """kind = "sweep"
version = 1
name = "A small map"
trial = "contact"

[axes]
patient = ["stiff-adult"]
delay_ticks = [0, 2]
stiffness = [1.0, 128.0]

[[maps]]
figure = "stable"
rows = "delay_ticks"
columns = "stiffness"
"""
CELLS = 4
FIGURES = ["stable", "certified", "refuted", "margin", "noise_n", "penetration_m", "faulted"]
RECORD = 8 + 8 * len(FIGURES) + 4  # docs/sweeps.md: index, figures, checksum
ROOT = {"OMPI_ALLOW_RUN_AS_ROOT": "1", "OMPI_ALLOW_RUN_AS_ROOT_CONFIRM": "1"}
FASTER = 1.8  # speed of two processes over one, on two idle cores


def digest(path):
    return hashlib.sha256(path.read_bytes()).hexdigest()


def cells_kept(folder):
    """Indices of the finished cells, read from the files as docs/sweeps.md describes."""
    found = []
    for path in sorted(folder.glob("*.cells")):
        data = path.read_bytes()
        found += [struct.unpack_from("<Q", data, at)[0] for at in range(0, len(data) - RECORD + 1, RECORD)]
    return found


class Sweep(AppTest):
    def setUp(self):
        super().setUp()
        self.grid = self.write("grid.toml", GRID)

    def sweep(self, out="a.h5", *more, code=DONE, **how):
        return self.expect(self.run_app("sweep", "grid.toml", "--out", out, *more, **how), code)

    def expect_alike(self, *names):
        files = [self.folder / f"{name}.h5" for name in names]
        self.assertEqual({digest(path) for path in files}, {digest(files[0])})
        self.assertEqual(list(self.folder.glob("*.cells")), [], "nothing else is left")

    def test_one_process_and_several_shares_write_the_same_bytes(self):
        self.sweep("one.h5", "--processes", 1)
        self.sweep("two.h5", "--processes", 2)
        for share in ("3/3", "1/3", "2/3"):
            said = self.sweep("shares.h5", "--share", share)
            self.assertEqual("the last share to end writes" in said.out, share != "2/3", said)
        for task in (4, 6):  # sbatch --array=4-6:2
            array = {"SLURM_ARRAY_TASK_ID": str(task), "SLURM_ARRAY_TASK_MIN": "4",
                     "SLURM_ARRAY_TASK_COUNT": "2", "SLURM_ARRAY_TASK_STEP": "2"}
            self.sweep("array.h5", "--array", env={**os.environ, **array})
        self.expect_alike("one", "two", "shares", "array")

    @unittest.skipUnless(LAB, "of the lab")
    def test_ranks_of_mpi_write_the_same_bytes_slow(self):
        self.sweep("one.h5", "--processes", 1)
        ranks = subprocess.run(["mpirun", "--oversubscribe", "-n", "2", BINARY, "sweep", "grid.toml", "--out", "ranks.h5"],
                               cwd=self.folder, env={**os.environ, **ROOT}, capture_output=True, text=True, timeout=HANG_S)
        self.assertEqual(ranks.returncode, 0, ranks.stdout + ranks.stderr)
        self.expect_alike("one", "ranks")

    def test_file_describes_the_sweep(self):
        self.sweep()
        with h5py.File(self.folder / "a.h5") as file:
            self.assertEqual(file.attrs["kind"], b"wholehand-sweep")
            self.assertEqual([name.decode() for name in file["axes"].attrs["order"]], ["patient", "delay_ticks", "stiffness"])
            self.assertEqual(list(file["axes/patient"].asstr()), ["stiff-adult"])
            self.assertEqual(list(file["axes/stiffness"]), [1.0, 128.0])
            self.assertEqual(file["grid"].asstr()[0], GRID)
            self.assertEqual(set(file["figures"]), set(FIGURES))
            stable, certified = file["figures/stable"][:], file["figures/certified"][:]
            self.assertEqual(stable.shape, (1, 2, 2))
        # Shipped gains are certified and come to rest; with 128 times the stiffness, and a delay beyond b / (T (1/2 +
        # n)), none does.
        self.assertTrue(certified[:, 0, 0].all() and stable[:, 0, 0].all())
        self.assertFalse(certified[:, 1, 1].any() or stable[:, 1, 1].any())
        self.assertFalse((certified * (1 - stable)).any(), "certified, but not at rest")

    def test_cell_equals_the_experiment_of_the_same_name(self):
        self.write("grid.toml", 'kind = "sweep"\nversion = 1\nname = "g"\ntrial = "grasp"\nhold_s = 10.0\n'
                                '[axes]\nobject = ["sphere"]\n')
        self.sweep()
        self.expect(self.run_app("experiment", "grasping", "--only", "power sphere floating", "--jittered", 0,
                                 "--json", "same.json"), DONE)
        trial, = json.loads((self.folder / "same.json").read_text())["trials"]
        with h5py.File(self.folder / "a.h5") as file:
            for figure, key in [("slip_m", "slip_m"), ("noise_n", "force_noise_n"), ("grip_n", "contact_force_n"),
                                ("carry_shift_m", "carry_shift_m"), ("tip_force_max_n", "tip_force_max_n")]:
                self.assertEqual(file["figures"][figure][0], trial[key], figure)

    def test_cell_can_be_played_by_a_patient(self):
        self.write("grid.toml", 'kind = "sweep"\nversion = 1\nname = "p"\ntrial = "play"\n[axes]\nseed = [1]\n')
        self.sweep()
        self.expect(self.run_app("experiment", "cocktail-bar", "--level", 1, "--seeds", 1, "--json", "same.json"), DONE)
        level, = json.loads((self.folder / "same.json").read_text())["levels"]
        with h5py.File(self.folder / "a.h5") as file:
            self.assertEqual(file["figures/completed"][0], level["completed"])
            self.assertEqual(file["figures/score"][0], level["score_median"])

    def kill_until_done(self, name, kills_left):
        """Starts and kills a sweep repeatedly, then finishes it. Returns the number of kills."""
        folder = self.folder / f"{name}.cells"
        kept, kills = [], 0
        while kills < kills_left:
            run = self.start_app("sweep", "grid.toml", "--out", name, start_new_session=True)
            more = len(kept) + self.random.randrange(2)  # some sweeps are killed before they finish a cell
            self.wait_until(run, lambda: len(cells_kept(folder)) > more)
            time.sleep(self.random.uniform(0.0, 0.2))
            whole_group = self.random.random() < 0.5
            if run.poll() is None:
                os.killpg(run.pid, signal.SIGKILL) if whole_group else run.kill()
                kills += 1
            run.communicate()
            if (self.folder / name).exists():
                break
            after = cells_kept(folder)
            self.assertLessEqual(set(kept), set(after), "a finished cell was lost")
            kept = after
        time.sleep(0.5)  # the worker processes of a killed program are killed, too
        before = cells_kept(folder)
        self.assertEqual(len(before), len(set(before)), "a cell was run twice")
        said = self.sweep(name)
        if not said.out.endswith(f"0 of them run now: {name}\n"):
            self.assertIn(f"{CELLS} cells, {CELLS - len(before)} of them run now", said.out)
        self.assertEqual(digest(self.folder / name), digest(self.folder / "whole.h5"))
        return kills

    def test_sweep_killed_at_random_loses_and_repeats_nothing(self):
        self.sweep("whole.h5")
        wanted, kills, sweeps = 20 if FULL else 2, 0, 0
        while kills < wanted and sweeps < 40:
            kills += self.kill_until_done(f"killed{sweeps}.h5", wanted - kills)
            sweeps += 1
        print(f"figure: kills of {sweeps} sweeps, no finished cell lost, none run twice {kills}")
        self.assertEqual(kills, wanted)

    def test_partial_or_damaged_cell_is_run_again(self):
        self.sweep("whole.h5")
        for name, damage in (("cut.h5", lambda cells: cells[:-5]), ("bad.h5", lambda cells: bytes([cells[0] ^ 64]) + cells[1:])):
            with self.subTest(name):
                self.sweep(name, "--share", "1/2", "--processes", 1)
                first, = (self.folder / f"{name}.cells").glob("0.cells")
                first.write_bytes(damage(first.read_bytes()))
                self.assertIn("3 of them run now", self.sweep(name, "--processes", 1).out)
                self.assertEqual(digest(self.folder / name), digest(self.folder / "whole.h5"))

    def test_dead_worker_is_reported_and_the_same_command_continues(self):
        run = self.start_app("sweep", "grid.toml", "--out", "a.h5", "--processes", 2)
        children = lambda: subprocess.run(["pgrep", "-P", str(run.pid)], capture_output=True, text=True).stdout.split()
        self.wait_until(run, lambda: len(children()) == 2)
        for child in children():
            os.kill(int(child), signal.SIGKILL)
        out, err = run.communicate()
        self.assertEqual(run.returncode, FAULT, out + err)
        self.assertRegex(err, r"a process that ran cells died; \d+ cells are kept, \d+ are left. The same command goes on")
        self.sweep()

    def test_interrupted_sweep_keeps_finished_cells(self):
        run = self.start_app("sweep", "grid.toml", "--out", "a.h5", "--processes", 1)
        self.wait_until(run, lambda: len(cells_kept(self.folder / "a.h5.cells")) > 0)
        run.send_signal(signal.SIGINT)
        out, err = run.communicate()
        self.assertEqual(run.returncode, INTERRUPTED, out + err)
        kept = int(re.search(r"Interrupted: (\d+) cells are kept, \d+ are left. The same command goes on", out)[1])
        self.assertIn(f"{CELLS - kept} of them run now", self.sweep().out)

    def test_finished_cells_are_not_run_again(self):
        self.sweep()
        before = (self.folder / "a.h5").stat().st_mtime_ns
        self.assertIn("0 of them run now", self.sweep().out)
        self.assertEqual((self.folder / "a.h5").stat().st_mtime_ns, before)

    def test_file_of_another_grid_is_refused(self):
        self.sweep()
        self.sweep("half.h5", "--share", "1/2")
        self.write("grid.toml", GRID.replace("128.0", "32.0"))
        self.expect_refused(self.run_app("sweep", "grid.toml", "--out", "a.h5"), "a.h5: holds another grid's results",
                            "name another --out, or remove the file", lines=1)
        self.expect_refused(self.run_app("sweep", "grid.toml", "--out", "half.h5"), "half.h5.cells: holds cells of another grid", lines=1)
        self.write("b.h5", "no HDF5")
        self.expect_refused(self.run_app("sweep", "grid.toml", "--out", "b.h5"), "b.h5: is no file of a sweep", lines=1)
        self.assertEqual((self.folder / "b.h5").read_text(), "no HDF5")

    def test_files_that_the_grid_reads_are_part_of_it(self):
        mine = self.write("mine.toml", (CONFIG / "patients/relaxed-adult.toml").read_text())
        self.write("grid.toml", GRID.replace('"stiff-adult"', '"mine.toml"'))
        self.sweep("half.h5", "--share", "1/2")
        mine.write_text(mine.read_text() + "# changed\n")
        self.expect_refused(self.run_app("sweep", "grid.toml", "--out", "half.h5"), "of other files")

    @unittest.skipUnless(shutil.which("strace"), "needs strace")
    def test_results_are_synced_before_the_cells_are_removed(self):
        log = self.folder / "calls"
        calls = "fsync,rename,renameat,renameat2,unlink,unlinkat,openat"
        self.expect(Result(subprocess.run(
            ["strace", "-f", "-y", "-o", log, "-e", f"trace={calls}", BINARY, "sweep", "grid.toml", "--out", "a.h5"],
            cwd=self.folder, timeout=HANG_S, text=True, stdin=subprocess.DEVNULL, capture_output=True)), DONE)
        lines = log.read_text().splitlines()

        def first(pattern, after=0):
            at = next((i for i in range(after, len(lines)) if re.search(pattern, lines[i])), None)
            self.assertIsNotNone(at, pattern)
            return at

        synced = first(r"fsync\(\d+<[^>]*/a\.h5\.\w+\.tmp>\) += 0")
        named = first(r'rename\w*\(.*"a\.h5"\) += 0', synced)
        kept = first(r"fsync\(\d+<%s>\) += 0" % re.escape(str(self.folder.resolve())), named)
        gone = [i for i, line in enumerate(lines) if re.search(r'unlink\w*\(.*"\d+\.cells"', line) and " = 0" in line]
        self.assertTrue(gone)
        self.assertGreater(gone[0], kept, "\n".join(lines[synced:gone[0] + 1]))

    def test_two_grids_started_on_one_file_do_not_mix(self):
        # Each sweep runs only a share, so no lock separates them; one of the two grids may take the file.
        (self.folder / "other.toml").write_text(GRID.replace("128.0", "64.0"))
        runs = [self.start_app("sweep", grid, "--out", "a.h5", "--share", "1/2") for grid in ("grid.toml", "other.toml") * 3]
        codes = {"grid.toml": [], "other.toml": []}
        for run, grid in zip(runs, ("grid.toml", "other.toml") * 3):
            run.communicate(timeout=HANG_S)
            codes[grid].append(run.returncode)
        self.assertEqual(sorted(set(codes["grid.toml"] + codes["other.toml"])), [DONE, BAD_INPUT], codes)
        self.assertEqual({len(set(of)) for of in codes.values()}, {1}, codes)

    def test_second_sweep_on_one_file_is_refused(self):
        run = self.start_app("sweep", "grid.toml", "--out", "a.h5", "--processes", 1)
        self.wait_until(run, lambda: (self.folder / "a.h5.cells/digest").exists())
        os.kill(run.pid, signal.SIGSTOP)
        refused = self.run_app("sweep", "grid.toml", "--out", "a.h5")
        os.kill(run.pid, signal.SIGCONT)
        self.expect_refused(refused, "a.h5.cells: is in use by another `wholehand sweep`", "--share", lines=1)
        out, err = run.communicate()
        self.assertEqual(run.returncode, DONE, out + err)

    def test_bad_grids_are_named(self):
        for change, texts in [
            (("stiffness", "stifness"), ["axes", "stifness", "is no axis of the trial contact", "device_damping"]),
            (("[1.0, 128.0]", "[]"), ["stiffness", "1 to 10000 numbers"]),
            (("[1.0, 128.0]", "[1.0, 1.0]"), ["stiffness", "has a value twice"]),
            (("[1.0, 128.0]", "[-1.0]"), ["stiffness", "-1", "(0, 1000]"]),
            (("[0, 2]", "[0.5]"), ["delay_ticks", "whole number"]),
            (('"stiff-adult"]', '"stiff-adult"]\nengine = ["bulet"]'), ["engine", "bulet", "bullet"]),
            (('"stiff-adult"]', '"nobody"]'), ["nobody.toml"]),
            (('rows = "delay_ticks"', 'rows = "hand"'), ["rows", "hand", "is no axis of this grid"]),
            (('figure = "stable"', 'figure = "stabel"'), ["figure", "stabel", "stable"]),
            (('trial = "contact"', 'trial = "contakt"'), ["trial", "contakt", "contact"]),
            (('kind = "sweep"', 'kind = "hand"'), ["sweep"]),
            (("[0, 2]", "[" + ",".join(f"{8 * i / 10000}" for i in range(0, 10000, 10000)) + "]\nsize = ["
              + ",".join(f"{1 + i / 1e5}" for i in range(9000)) + "]\nfriction = [" + ",".join(f"{i / 1e4}" for i in range(9000)) + "]"),
             ["cells", "at most 1000000"]),
        ]:
            with self.subTest(texts=texts):
                self.write("grid.toml", GRID.replace(*change))
                self.expect_refused(self.run_app("sweep", "grid.toml", "--out", "bad.h5"), *texts)
                self.assertFalse((self.folder / "bad.h5").exists())

    def test_grid_is_validated_like_any_file(self):
        said = self.expect(self.run_app("validate", "grid.toml"), DONE, "ok  sweep", "4 cells (1 patient × 2 delay_ticks × 2 stiffness)")
        self.assertEqual(said.err, "")
        self.write("grid.toml", GRID.replace("stiff-adult", "nobody"))
        self.expect_refused(self.run_app("validate", "grid.toml"), "nobody.toml", "is not there", lines=1)

    def test_cells_that_cannot_run_are_refused_by_validate(self):
        for trial, axes, words in (
                ("grasp", 'posture = ["power", "pinch"]\nobject = ["sphere", "disk"]', ["grid.toml:6", "object disk", "pinch takes"]),
                ("contact", 'posture = ["pinch"]', ["object cylinder"]),
                ("play", 'exercise = ["cocktail-bar", "drawer"]', ["drawer.toml", "virtual patient can win"]),
                ("play", "level = [1, 99]", ["level = 99", "levels 1 to"]),
                ("grasp", 'hand = ["man-p50-right"]\nrendering = ["lambda-pride", "desktop-3axis"]', ["no gains for finger_flexion"])):
            self.write("grid.toml", f'kind = "sweep"\nversion = 1\nname = "g"\ntrial = "{trial}"\n[axes]\n{axes}\n')
            for command in (("validate", "grid.toml"), ("sweep", "grid.toml", "--out", "a.h5")):
                with self.subTest(axes=axes, command=command[0]):
                    self.expect_refused(self.run_app(*command), *words, lines=1)
        self.assertEqual(self.names_in(self.folder), ["grid.toml"])

    def test_bad_shares_are_named(self):
        for share in ("0/2", "3/2", "1/0", "x", "1/2/3"):
            with self.subTest(share=share):
                self.expect_refused(self.run_app("sweep", "grid.toml", "--out", "a.h5", "--share", share), "--share", share, lines=1)
        self.expect_refused(self.run_app("sweep", "grid.toml", "--out", "a.h5", "--array"), "--array", "sbatch", lines=1)
        self.expect_refused(self.run_app("sweep", "grid.toml", "--out", "grid.toml/a.h5"), "grid.toml/a.h5.cells", "cannot be written")

    def test_shipped_grids_are_well_formed(self):
        for grid in sorted((CONFIG / "sweeps").glob("*.toml")):
            with self.subTest(grid=grid.name):
                run = self.start_app("sweep", grid, "--out", f"{grid.stem}.h5")
                self.wait_until(run, lambda: len(list((self.folder / f"{grid.stem}.h5.cells").glob("*.cells"))) > 0)
                run.kill()

    @unittest.skipUnless(LAB, "of the lab: it compares with ranks")
    def test_two_processes_are_nearly_twice_as_fast_slow(self):
        def wall_s(out, *start):
            shutil.rmtree(self.folder / f"{out}.cells", ignore_errors=True)
            began = time.monotonic()
            subprocess.run([*start, BINARY, "sweep", CONFIG / "sweeps/stability-map.toml", "--out", out], cwd=self.folder,
                           env={**os.environ, **ROOT}, check=True, capture_output=True)
            return time.monotonic() - began
        one = min(wall_s(f"one{i}.h5", "taskset", "-c", "0") for i in range(2))
        two = min(wall_s(f"two{i}.h5") for i in range(2))
        ranks = min(wall_s(f"ranks{i}.h5", "mpirun", "-n", "2") for i in range(2))
        print(f"figure: two processes over one {one / two:.2f}, two ranks over two processes {two / ranks:.2f}")
        self.assertGreaterEqual(one / two, FASTER)
        self.assertGreaterEqual(two / ranks, 0.95)


if __name__ == "__main__":
    main()
