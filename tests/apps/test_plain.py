"""A recording is plain HDF5: h5py, h5dump and Octave read the same values of each documented dataset, which match the
run's summary. `--resimulate` compares the numbers with a new simulation."""
import json
import pathlib
import re
import shutil
import subprocess
import tempfile

import h5py
import numpy

from app import (BAD_INPUT, CONFIG, DIFFERENT, DONE, FREE_RUN, FULL, NOT_WHOLE, AppTest, limit_file_size, main,
                 read_recording, report_data)

DOCUMENT = (pathlib.Path(__file__).resolve().parents[2] / "docs/recording.md").read_text()
NUMBERS = {"float32": "<f4", "float64": "<f8", "int32": "<i4", "int64": "<i8", "uint32": "<u4", "uint64": "<u8"}


def documented():
    """Name and type of each dataset of /ticks, from the table of docs/recording.md."""
    types = {}
    for names, kinds in re.findall(r"^\| (`\w+`(?:, `\w+`)*) \|[^|]*\| ([\w, ]+) \|", DOCUMENT, re.MULTILINE):
        names, kinds = re.findall(r"`(\w+)`", names), kinds.split(", ")
        types.update(zip(names, kinds * len(names) if len(kinds) == 1 else kinds))
    return types


class Plain(AppTest):
    def setUp(self):
        super().setUp()
        self.path = self.record("run.h5", "--exercise", "cocktail-bar", "--json", "run.json", duration=8.0)
        self.summary = json.loads((self.folder / "run.json").read_text())

    def test_each_dataset_is_documented_and_of_its_type(self):
        types = documented()
        self.assertGreater(len(types), 40, "the table of docs/recording.md is not read")
        drawer = self.record("drawer.h5", "--exercise", "drawer", duration=0.3)
        with h5py.File(self.path, "r") as f, h5py.File(drawer, "r") as with_joint:
            self.assertEqual(set(with_joint["ticks"]) - set(f["ticks"]), {"body_q", "body_qd"})
            self.assertEqual([unit.decode() for unit in with_joint["ticks/body_q"].attrs["units"]], ["m"])
            self.assertEqual(set(types), set(with_joint["ticks"]))
            for name, dataset in with_joint["ticks"].items():
                self.assertEqual(dataset.dtype.str, NUMBERS[types[name]], name)
                self.assertIn("units", dataset.attrs, name)
                self.assertEqual((dataset.compression, dataset.shuffle), ("gzip", True), name)
                filters = dataset.id.get_create_plist().get_nfilters()
                self.assertEqual(filters, 2, name)  # only filters that every reader has

    def test_numbers_are_those_of_the_summary(self):
        with h5py.File(self.path, "r") as f:
            ticks = {name: dataset[:] for name, dataset in f["ticks"].items()}
            axes = [name.decode() for name in f["ticks/sent"].attrs["labels"]]
            period_s = f["meta"].attrs["period_s"]
            rows = f["contacts/row"][:]
        self.assertEqual(self.summary["ticks"], ticks["elapsed_periods"].sum())
        self.assertEqual(self.summary["contacts_max"], ticks["contact_count"].max())
        for axis, largest in self.summary["max_effort"].items():
            self.assertAlmostEqual(numpy.abs(ticks["sent"][:, axes.index(axis)]).max(), largest, delta=1.2e-7 * largest)
        numpy.testing.assert_array_equal(ticks["time_s"], ticks["tick"] * period_s)  # bit-identical
        for bit, name in ((6, "effort_limited"), (14, "power_limited")):
            said = self.summary.get("fault_ticks", {}).get(name, 0)
            self.assertEqual(said, int((ticks["faults"] >> bit & 1).sum()), name)
        # A contact belongs to the tick that counts it.
        touched, counts = numpy.unique(rows[rows >= 0], return_counts=True)
        numpy.testing.assert_array_equal(counts, ticks["contact_count"][touched])
        self.assertGreater(len(touched), 100, "nothing was touched")
        # f_m is the sum of its parts (Eq. 3), each rounded to single precision.
        parts = [ticks[name].astype(float) for name in ("coupling", "exercise_effort", "damping", "tank_effort")]
        bound = 1.2e-7 * (sum(numpy.abs(part) for part in parts) + numpy.abs(ticks["rendered"]))
        self.assertTrue((numpy.abs(sum(parts) - ticks["rendered"]) <= bound).all())
        # Nobody steers, so the virtual patient moves.
        self.assertEqual(set(ticks["moved_by"]), {2})

    def test_h5dump_reads_the_same(self):
        with h5py.File(self.path, "r") as f:
            for name, dataset in f["ticks"].items():
                with tempfile.NamedTemporaryFile() as numbers:
                    subprocess.run(["h5dump", "-d", f"/ticks/{name}", "-b", "LE", "-o", numbers.name, str(self.path)],
                                   check=True, capture_output=True)
                    read = numpy.fromfile(numbers.name, dataset.dtype).reshape(dataset.shape)
                self.assertEqual(read.tobytes(), dataset[:].tobytes(), name)

    def test_octave_reads_the_same_slow(self):
        program = "load('run.h5', 'ticks'); names = fieldnames(ticks);" \
                  "for i = 1:numel(names) v = ticks.(names{i}); printf('%s %d %.17g\\n', names{i}, numel(v)," \
                  " sum(double(v(isfinite(double(v)))))); end"
        said = subprocess.run(["octave-cli", "--no-init-file", "--eval", program], cwd=self.folder, check=True, text=True,
                              capture_output=True).stdout
        read = {name: (int(size), float(total)) for name, size, total in (line.split() for line in said.splitlines())}
        with h5py.File(self.path, "r") as f:
            self.assertEqual(set(read), set(f["ticks"]))
            for name, dataset in f["ticks"].items():
                numbers = dataset[:].astype(float)
                expected = numbers[numpy.isfinite(numbers)].sum()
                self.assertEqual(read[name][0], numbers.size, name)
                self.assertAlmostEqual(read[name][1], expected, delta=1e-9 * numpy.abs(expected) + 1e-12, msg=name)

    def test_recording_can_be_rebuilt_from_the_inputs_after_a_kill(self):
        run = self.start_app(*FREE_RUN, "--no-rehearsal", "--duration", "60", "--record", "killed.h5")
        self.wait_until_it_renders(run)

        def rows_there():
            with read_recording(self.folder / "killed.h5") as growing:
                return growing.rows()

        self.wait_until(run, lambda: rows_there() >= 1000)
        run.kill()
        run.wait()
        self.expect_refused(self.run_app("replay", "killed.inputs"), "--extract", lines=1)
        left = (self.folder / "killed.inputs").read_bytes()
        self.expect_refused(self.run_app("replay", "killed.inputs", "--extract", "killed.h5"),
                            "would replace the inputs that it is made of", lines=1)
        full = self.run_app("replay", "killed.inputs", "--extract", "short.h5", preexec_fn=limit_file_size(1_000_000))
        self.expect_refused(full)
        self.assertEqual((self.folder / "killed.inputs").read_bytes(), left)
        self.expect(self.run_app("replay", "killed.inputs", "--extract", "again.h5"), DONE, "made again")
        with read_recording(self.folder / "killed.h5") as killed, h5py.File(self.folder / "again.h5", "r") as again:
            rows = killed.rows()
            self.assertGreaterEqual(rows, 1000)
            self.assertGreaterEqual(len(again["ticks/tick"]), rows)  # the inputs are written at least as early
            for name in ("tick", "digest", "q_m", "sent", "moved_by"):
                self.assertEqual(killed["ticks"][name][:rows].tobytes(), again["ticks"][name][:rows].tobytes(), name)
        self.expect_same_when_run_again("again.h5")

    def test_inputs_are_removed_once_the_recording_is_complete(self):
        self.assertEqual(self.names_in(self.folder), ["run.h5", "run.json"])

    def test_resimulation_of_a_replayed_motion_is_identical(self):
        path = self.record("motion.h5", "--motion", CONFIG.parent / "data/human-motion/reach-grasp-00.csv", duration=2.0)
        with h5py.File(path, "r") as f:
            self.assertEqual(set(f["ticks/moved_by"][:]), {3})
        self.expect_same_when_run_again(path)
        self.expect_same_when_run_again(self.path)


def cut_row(dataset, row):
    rest = numpy.delete(dataset[:], row, axis=0)
    dataset.resize(len(rest), axis=0)
    dataset[:] = rest


class Edited(AppTest):
    """A recording that was edited with h5py; the expected messages follow from the edit."""

    # Datasets of /ticks that are inputs of a simulation, depend on the clock, or are counts; a tick computes all
    # others.
    NO_RESULT = {"tick", "time_s", "elapsed_periods", "lateness_ns", "wall_ns", "cpu_ns", "stage_cpu_ns", "moved_by", "help",
                 "digest", "q_m", "intention", "patient_effort", "faults", "parameters", "event_count", "command_count",
                 "contact_count"}

    def setUp(self):
        super().setUp()
        self.path = self.record("run.h5", "--exercise", "cocktail-bar", duration=8.0)
        with h5py.File(self.path, "r") as f:
            self.ticks = len(f["ticks/tick"])
            quiet = numpy.flatnonzero((f["ticks/contact_count"][:] == 0) & (f["ticks/event_count"][:] == 0))
        self.row = int(self.random.choice(quiet[(quiet > 1000) & (quiet < self.ticks - 1000)]))

    def edit(self):
        shutil.copy(self.path, self.folder / "edited.h5")
        return h5py.File(self.folder / "edited.h5", "r+", libver="latest")

    def expect_shown(self, ticks, *texts):
        """Expects replay and report to show so many ticks, and to give these reasons for the missing ones."""
        shown = self.expect(self.run_app("replay", "--speed", "1000", "edited.h5"), NOT_WHOLE, f", {ticks} ticks", *texts)
        self.assertGreaterEqual(len(shown.out.splitlines()), ticks // 100)
        self.expect(self.run_app("replay", "edited.h5", "--report", "page.html"), NOT_WHOLE, *texts)
        data = report_data(self.folder / "page.html")
        self.assertEqual((data["about"]["ticks"], data["about"]["ticks_missing"]), (ticks, self.ticks - ticks))

    def test_row_cut_from_every_dataset_is_a_missing_tick(self):
        with self.edit() as f:
            for dataset in f["ticks"].values():
                cut_row(dataset, self.row)
            for table in ("contacts", "events", "commands"):
                rows = f[table]["row"][:]
                f[table]["row"][:] = rows - (rows > self.row)
        self.expect_refused(self.run_app("replay", "--resimulate", "edited.h5"), f"tick {self.row} is missing", lines=1)
        self.expect_shown(self.ticks - 1, "1 tick is missing")

    def test_row_cut_from_one_dataset_is_reported_with_the_dataset(self):
        with h5py.File(self.path, "r") as f:
            names = sorted(f["ticks"])
        for name in names if FULL else self.random.sample(names, 8):
            with self.subTest(name), self.edit() as f:
                values = f["ticks"][name][:]
                cut_row(f["ticks"][name], self.row)
                f.close()
                lengths = f"/ticks has {self.ticks - 1} rows of '{name}', {self.ticks} of '"
                result = self.run_app("replay", "--resimulate", "edited.h5")
                self.assertIn(result.code, (DIFFERENT, BAD_INPUT), result)
                bits = values.reshape(self.ticks, -1).view(f"u{values.itemsize}")
                changed = numpy.flatnonzero((bits[1:] != bits[:-1]).any(axis=1))
                changed = changed[changed >= self.row]  # row r has the values of row r + 1
                if name == "tick":
                    self.expect_refused(result, f"tick {self.row} is missing")
                elif name not in self.NO_RESULT and len(changed):
                    self.expect(result, DIFFERENT, f"tick {changed[0]} has other numbers", f"  {name}", lengths)
                elif result.code == DIFFERENT:
                    self.assertIn(lengths, result.err)
                else:
                    self.assertRegex(result.err, rf"tick \d+ has \d+ rows? in /\w+, its {name} says \d+")
        self.expect(self.run_app("replay", "--speed", "1000", "edited.h5"), NOT_WHOLE, lengths)
        self.expect(self.run_app("replay", "edited.h5", "--report", "page.html"), NOT_WHOLE, lengths)

    def insert_event(self, f):
        at = int(numpy.searchsorted(f["events/row"][:], self.row))
        for name, number in (("row", self.row), ("type", 0), ("index", -1), ("value", 1.0)):
            dataset = f["events"][name]
            numbers = numpy.insert(dataset[:], at, number)
            dataset.resize(len(numbers), axis=0)
            dataset[:] = numbers

    def test_inserted_event_contradicts_the_count_of_its_tick(self):
        with self.edit() as f:
            self.insert_event(f)
        said = f"tick {self.row} has 1 row in /events, its event_count says 0"
        self.expect_refused(self.run_app("replay", "--resimulate", "edited.h5"), said, lines=1)
        self.expect_shown(self.ticks - 1, said)

    def test_inserted_and_counted_event_is_found_by_resimulation(self):
        with self.edit() as f:
            self.insert_event(f)
            f["ticks/event_count"][self.row] += 1
        self.expect(self.run_app("replay", "--resimulate", "edited.h5"), DIFFERENT,
                    f"tick {self.row} has other numbers than its digest says", "event_count: recorded 1, now 0")

    def test_missing_column_affects_only_its_own_output(self):
        for name, in_report in (("phi", True), ("digest", False), ("sent", True)):
            with self.subTest(name):
                with self.edit() as f:
                    del f["ticks"][name]
                said = f"has no dataset '{name}'"
                self.expect_refused(self.run_app("replay", "--resimulate", "edited.h5"), said, lines=1)
                report = self.run_app("replay", "edited.h5", "--report", "page.html")
                self.expect(report, BAD_INPUT if in_report else NOT_WHOLE, said)
                # The printed lines show the sent efforts and do not need the other two columns.
                self.expect(self.run_app("replay", "--speed", "1000", "edited.h5"),
                            BAD_INPUT if name == "sent" else NOT_WHOLE, said)


if __name__ == "__main__":
    main()
