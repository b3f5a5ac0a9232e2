"""`wholehand replay --resimulate`: bit-identical, or the first tick and field that differ."""
import json
import os
import shutil
import signal
import time

import h5py
import numpy

from app import BAD_INPUT, CONFIG, DIFFERENT, DONE, FREE_RUN, FULL, HANG_S, INTERRUPTED, SOURCE, AppTest, loop_sleeps, main, read_recording


def flip_last_bit(path, dataset, row, column=None):
    """Changes the lowest bit of one recorded number, which is the smallest possible change."""
    with h5py.File(path, "r+", libver="latest") as f:
        values = f[dataset]
        at = (row,) if column is None else (row, *column) if isinstance(column, tuple) else (row, column)
        number = numpy.array(values[at])
        bits = number.view(f"u{number.itemsize}")
        values[at] = (bits ^ bits.dtype.type(1)).view(number.dtype)


class Same(AppTest):
    CASES = {
        "six axes": [],
        "three axes": ["--scene", CONFIG / "scenes/four-shapes.toml", "--device",
                       CONFIG / "devices/desktop-3axis.toml"],
        "nine axes": ["--device", CONFIG / "devices/wrist-9axis.toml"],
        "left hand": ["--hand", CONFIG / "hands/adult-median-left.toml"],
        "at 2 kHz": ["--rate-hz", "2000"],
        "mesh and URDF": ["--scene", CONFIG / "scenes/table.toml"],
        "no body, no arm": ["--scene", CONFIG / "scenes/empty.toml", "--patient",
                            CONFIG / "patients/no-arm.toml"],
    }

    def test_run_on_the_simulated_clock_is_identical(self):
        for name, arguments in self.CASES.items():
            with self.subTest(name):
                path = self.record("run.h5", *arguments, duration=9.0 if FULL or not arguments else 4.0)
                self.expect_same_when_run_again(path)

    def test_urdf_as_a_scene_is_recorded_with_the_scene_made_of_it(self):
        (self.folder / "parts").mkdir()
        shutil.copy(CONFIG / "scenes/assets/octagonal-prism.obj", self.folder / "parts/flap.obj")
        part = "<collision><geometry>{}</geometry></collision>"
        thing = self.write("thing.urdf", "<robot name='t'><link name='case'>" + part.format("<box size='.2 .2 .2'/>") +
                           "</link><link name='flap'>" + part.format("<mesh filename='parts/flap.obj' scale='.001 .001 .001'/>") +
                           "</link><joint name='j' type='revolute'><parent link='case'/><child link='flap'/>"
                           "<axis xyz='0 0 1'/><limit lower='0' upper='1'/></joint></robot>")
        path = self.record("run.h5", "--scene", thing, duration=1.0)
        with read_recording(path) as f:
            names = [f["meta/files"][group].attrs["name"] for group in f["meta/files"]]
        for name in (b"thing.urdf.toml", b"thing.urdf", b"parts/flap.obj"):
            self.assertTrue(any(recorded.endswith(name) for recorded in names), names)
        self.expect_same_when_run_again(path)
        thing.unlink()  # the recording holds it
        self.expect_same_when_run_again(path)

    def test_hand_that_touches_itself_is_identical(self):
        # An empty fist, closed within a second and opened again: thumb and fingers stop each other.
        lines = ["time_s,x_m,y_m,z_m,finger_flexion_rad,thumb_circumduction_rad,thumb_flexion_rad"]
        for k in range(451):
            closed = min(1.0, k / 100, (450 - k) / 100)
            lines.append(f"{k / 100},0,0,0,{3.1 * closed},1.5,{1.35 * closed}")
        motion = self.folder / "fist.csv"
        motion.write_text("\n".join(lines) + "\n")
        path = self.record("fist.h5", "--motion", motion, "--scene", CONFIG / "scenes/empty.toml", duration=5.0)
        with read_recording(path) as f:
            apart = numpy.abs(f["ticks/q_s"][:] - f["ticks/q_m"][:]).max(axis=0)
            self.assertEqual(f["ticks/contact_count"][:].max(), 0)
        self.assertGreater(apart[5], 0.01)  # the fingers stopped the thumb [rad]
        self.expect_same_when_run_again(path)

    def test_same_files_give_the_same_ticks(self):
        first, second = self.record("a.h5"), self.record("b.h5")
        with read_recording(first) as a, read_recording(second) as b:
            for name in ("q_m", "theta", "sent", "bodies", "coupling"):
                self.assertEqual(a["ticks/" + name][:].tobytes(), b["ticks/" + name][:].tobytes(), name)

    def test_real_time_run_with_skipped_ticks_is_identical(self):
        run = self.start_app(*FREE_RUN, "--no-rehearsal", "--duration", "600", "--record", "run.h5", "--json", "run.json")
        self.wait_until_it_renders(run)
        for _ in range(3):  # simulates stalls of the machine
            run.send_signal(signal.SIGSTOP)
            time.sleep(0.05)
            slept = loop_sleeps(run.pid)
            run.send_signal(signal.SIGCONT)
            self.wait_until(run, lambda: loop_sleeps(run.pid) > slept + 100)
        run.send_signal(signal.SIGINT)
        said, complained = run.communicate(timeout=HANG_S)
        self.assertEqual(run.returncode, INTERRUPTED, said + complained)
        summary = json.loads((self.folder / "run.json").read_text())
        with read_recording(self.folder / "run.h5") as f:
            tick, elapsed = f["ticks/tick"][:], f["ticks/elapsed_periods"][:]
        # Skipped periods keep their place in time: no burst and no drift; all of them are reported.
        self.assertGreaterEqual((elapsed > 20).sum(), 3)
        self.assertTrue((tick[1:].astype(int) - tick[:-1].astype(int) == elapsed[1:]).all())
        self.assertGreaterEqual(summary["missed_deadlines"], 3)
        self.assertEqual(summary["ticks"], tick[-1] + 1)
        self.expect_same_when_run_again("run.h5")

    def test_resimulation_leaves_no_files(self):
        path = self.record(duration=0.3)
        scratch = self.folder / "scratch"
        scratch.mkdir()
        environment = dict(os.environ, TMPDIR=str(scratch))
        for arguments in (["replay", "--resimulate"], ["replay", "--report", "r.html"]):
            self.expect(self.run_app(*arguments, path, env=environment), DONE)
        self.assertEqual(self.names_in(scratch), [])
        self.assertEqual(self.names_in(self.folder), ["r.html", "run.h5", "scratch"])


class BlackBox(AppTest):
    """The black box file of a run crashed from outside; test_black_box* tests all kinds of crashes and faults."""

    def crash(self, *arguments, after=1.0, written=None):
        """@param written a recording whose file must contain ticks before the crash"""
        run = self.start_app(*FREE_RUN, "--no-rehearsal", "--duration", "60", *arguments)
        time.sleep(after)
        self.wait_until_it_renders(run)
        if written is not None:
            self.wait_until(run, lambda: self.ticks_in(written) > 0)
        run.send_signal(signal.SIGSEGV)
        said, complained = run.communicate(timeout=HANG_S)
        self.assertEqual(run.returncode, -signal.SIGSEGV, said + complained)
        return complained

    def ticks_in(self, name):
        try:
            with read_recording(self.folder / name) as recording:
                return len(recording["ticks/tick"])
        except (OSError, KeyError):
            return 0

    def test_crashed_run_reports_its_black_box_file_which_is_valid(self):
        said = self.crash("--record", "run.h5", written="run.h5")
        self.assertIn("wholehand: crashed; the last seconds are in run.wbb: "
                      "wholehand replay run.wbb --resimulate", said)
        self.expect_same_when_run_again("run.wbb")
        shown = self.expect(self.run_app("replay", "--speed", "1000", "run.wbb"), DONE, "SIGSEGV")
        self.assertRegex(shown.out, r"inputs of \d+ ticks since arming, all of them")
        self.expect(self.run_app("replay", "run.wbb", "--extract", "last.h5"), DONE, "last.h5: ")
        with read_recording(self.folder / "last.h5") as last, \
                read_recording(self.folder / "run.h5") as run:
            tick, recorded = last["ticks/tick"][:], run["ticks/tick"][:]
            common = numpy.intersect1d(tick, recorded)
            self.assertGreater(len(common), 0)
            for name in ("q_m", "sent", "bodies", "theta", "safety_state"):
                self.assertEqual(last["ticks/" + name][:][numpy.isin(tick, common)].tobytes(),
                                 run["ticks/" + name][:][numpy.isin(recorded, common)].tobytes(), name)
        self.expect(self.run_app("report", "run.wbb", "--out", "report"), DONE)

    def test_run_without_recording_leaves_its_black_box_file_in_a_new_folder(self):
        said = self.crash("--json", "run.json")
        names = [n for n in self.names_in(self.folder) if n.endswith(".wbb")]
        self.assertEqual(len(names), 1, names)
        self.assertRegex(names[0], r"^out/blackbox/\d{8}-\d{6}-[0-9a-f]{8}\.wbb$")
        self.assertIn(names[0], said)

    def test_run_without_fault_leaves_no_black_box_file(self):
        self.record(duration=0.3)
        self.assertEqual(self.names_in(self.folder), ["run.h5"])

    def test_extract_of_a_recording_is_refused(self):
        path = self.record(duration=0.3)
        self.expect_refused(self.run_app("replay", path, "--extract", "x.h5"), "is a recording already", lines=1)
        self.assertFalse((self.folder / "x.h5").exists())


class Different(AppTest):
    def setUp(self):
        super().setUp()
        self.path = self.record(duration=1.5)

    def test_recording_of_another_version_is_reported(self):
        with h5py.File(self.path, "r+", libver="latest") as f:
            f["meta"].attrs["git_version"] = "0.0.9 (older)"
        flip_last_bit(self.path, "ticks/f_s", 700, 2)
        result = self.expect(self.run_app("replay", "--resimulate", self.path), DIFFERENT)
        self.assertIn("(recorded by 0.0.9 (older), this is ", result.out)

    def test_recording_of_this_version_mentions_no_version(self):
        self.assertNotIn("recorded by", self.changed("ticks/f_s", 700, 2).out)

    def changed(self, dataset, row, column=None):
        copy = self.folder / "changed.h5"
        shutil.copy(self.path, copy)
        flip_last_bit(copy, dataset, row, column)
        return self.run_app("replay", "--resimulate", copy)

    def test_changed_bit_of_a_number_is_reported_at_its_place(self):
        for dataset, row, column, where in (("f_s", 700, 2, "f_s of z"), ("sent", 700, 1, "sent of y"),
                                            ("theta", 1499, 3, "theta[3]"), ("bodies", 1000, (1, 0), "bodies[13]"),
                                            ("rendered", 321, 0, "rendered of x"),
                                            ("palm_distance_m", 900, None, "palm_distance_m")):
            with self.subTest(dataset):
                result = self.changed("ticks/" + dataset, row, column)
                self.expect(result, DIFFERENT, f"tick {row} has other numbers than its digest says", where + ":")

    def test_differing_digest_is_reported(self):
        self.expect(self.changed("ticks/digest", 500), DIFFERENT, "tick 500 differs by its digest",
                    "no tick in single precision")

    def test_changed_bit_of_an_input_is_found(self):
        # q_m is an input: the tick uses the changed value, and its results differ. The last bit is far below single
        # precision, so the digest shows it first.
        result = self.expect(self.changed("ticks/q_m", 800, 1), DIFFERENT)
        self.assertRegex(result.out, r"tick 800 differs by its digest")

    def test_missing_row_or_column_is_named(self):
        with h5py.File(self.path, "r+", libver="latest") as f:
            del f["ticks/phi"]
        for arguments in (["replay", "--resimulate"], ["report", "--out", "report"]):
            self.expect_refused(self.run_app(*arguments, self.path), "has no dataset 'phi'", lines=1)

    def test_other_configuration_is_reported_as_different(self):
        copy = self.folder / "changed.h5"
        shutil.copy(self.path, copy)
        with h5py.File(copy, "r+", libver="latest") as f:
            for group in f["meta/files"]:
                file = f["meta/files"][group]
                if not file.attrs["name"].endswith(b"rendering/lambda-pride.toml"):
                    continue
                text = bytes(file[()]).replace(b"k_pm_n_m = 1000.0", b"k_pm_n_m = 1001.0")
                replace_text(f, group, text)
        result = self.expect(self.run_app("replay", "--resimulate", copy), DIFFERENT)
        self.assertRegex(result.out, r"tick \d+ differs")


def replace_text(f, group, text, name=None):
    """Replaces the text of an embedded file and keeps its attributes."""
    old = f["meta/files"][group]
    attributes = dict(old.attrs)
    dtype, shape = old.dtype, old.shape
    del f["meta/files"][group]
    if dtype.kind == "u" or dtype.kind == "i":
        new = f["meta/files"].create_dataset(group, data=list(text), dtype=dtype)
    else:
        new = f["meta/files"].create_dataset(group, data=text, dtype=dtype, shape=shape)
    for key, value in attributes.items():
        new.attrs[key] = value
    if "bytes" in attributes:
        new.attrs["bytes"] = type(attributes["bytes"])(len(text))
    if name is not None:
        new.attrs["name"] = numpy.bytes_(name)


class Foreign(AppTest):
    def commands(self, path):
        return (["replay", path], ["replay", "--resimulate", path],
                ["report", path, "--out", "report"], ["replay", path, "--report", "page.html"])

    def expect_all_refuse(self, path, *texts):
        before = self.names_in(self.folder)
        for arguments in self.commands(path):
            with self.subTest(" ".join(map(str, arguments))):
                self.expect_refused(self.run_app(*arguments), str(path), *texts, lines=1)
        self.assertEqual(self.names_in(self.folder), before)  # no partial file

    def test_other_files_are_refused(self):
        self.write("text.h5", "time,force\n0,1\n")
        self.write("empty.h5", "")
        self.write("garbage.h5", bytes(range(256)) * 4000)
        (self.folder / "folder.h5").mkdir()
        with h5py.File(self.folder / "foreign.h5", "w") as f:
            f["results"] = [1.0, 2.0]
        for name in ("text.h5", "empty.h5", "garbage.h5", "folder.h5", "foreign.h5", "missing.h5"):
            self.expect_all_refuse(name)

    def test_corrupted_bytes_never_crash(self):
        whole = self.record(duration=1.0).read_bytes()
        for trial in range(300 if FULL else 20):
            corrupted = bytearray(whole)
            # Anywhere, or in the second half, where the ticks are and one may still be read.
            first = 0 if trial % 2 else len(corrupted) // 2
            for _ in range(self.random.randrange(1, 100)):
                at = self.random.randrange(first, len(corrupted))
                corrupted[at] = self.random.randrange(256)
            path = self.write("corrupted.h5", bytes(corrupted))
            with self.subTest(trial=trial):
                result = self.run_app("replay", "--resimulate", path)
                self.assertIn(result.code, (DONE, DIFFERENT, BAD_INPUT), result)
                self.assertNotIn("HDF5-DIAG", result.err)

    def test_recording_of_a_later_version_is_refused(self):
        path = self.record(duration=0.2)
        with h5py.File(path, "r+", libver="latest") as f:
            version = f["meta"].attrs["schema_version"]
            f["meta"].attrs.modify("schema_version", type(version)(99))
        self.expect_all_refuse(path, "99")
        with self.assertRaisesRegex(ValueError, "run.h5: schema_version = 99: .* update it"):
            read_recording(path)

    def test_earlier_version_is_refused_with_the_program_that_reads_it(self):
        path = self.record(duration=0.2)
        with h5py.File(path, "r+", libver="latest") as f:
            f["meta"].attrs.modify("schema_version", numpy.uint64(8))
            written_by = f["meta"].attrs["git_version"].decode()
        self.expect_all_refuse(path, "schema_version = 8", "of an earlier version", written_by)
        with self.assertRaisesRegex(ValueError, "run.h5: schema_version = 8: .* of its time"):
            read_recording(path)

    def test_schema_before_is_replayed_but_not_run_again(self):
        path = self.folder / "nine.h5"
        shutil.copy(SOURCE / "tests/record/data/schema_9.h5", path)
        self.expect(self.run_app("replay", path), DONE, "12 ticks")
        self.expect_refused(self.run_app("replay", path, "--resimulate"), "schema version 9", "9893d4ac", lines=1)
        with read_recording(path) as f:
            numpy.testing.assert_array_equal(f["ticks/sent"][:, 0], numpy.arange(12) + 1.0)

    def test_embedded_file_names_outside_the_folder_are_refused(self):
        path = self.record(duration=0.2)
        victim = self.folder / "victim.toml"
        for name in ("../../../../../../../.." + str(victim), str(victim), "a/../../victim.toml", ".."):
            copy = self.folder / "escaping.h5"
            shutil.copy(path, copy)
            with h5py.File(copy, "r+", libver="latest") as f:
                f["meta/files/0"].attrs["name"] = numpy.bytes_(name)
            with self.subTest(name=name):
                self.expect_refused(self.run_app("replay", copy, "--resimulate"), name, lines=1)
            self.assertFalse(victim.exists())

    def test_recording_without_its_scene_is_refused(self):
        path = self.record(duration=0.2)
        with h5py.File(path, "r+", libver="latest") as f:
            for group in list(f["meta/files"]):
                if b"scenes/" in f["meta/files"][group].attrs["name"]:
                    f["meta/files"][group].attrs["name"] = numpy.bytes_("scene.txt")
        self.expect_refused(self.run_app("replay", "--resimulate", path), "run.h5",
                            "carries no scene file", lines=1)

    def test_error_in_an_embedded_file_names_the_recording(self):
        path = self.record(duration=0.2)
        with h5py.File(path, "r+", libver="latest") as f:
            for group in list(f["meta/files"]):
                file = f["meta/files"][group]
                if file.attrs["name"].endswith(b"lambda-pride.toml"):
                    text = bytes(file[()]).replace(b"version = 1 ", b"version = 2 ")
                    replace_text(f, group, text)
        result = self.expect_refused(self.run_app("replay", "--resimulate", path),
                                     "run.h5: config/devices/lambda-pride.toml:", "version = 2")
        self.assertNotIn("/tmp", result.err.replace(str(self.folder), ""))

    def test_missing_folder_for_temporary_files_is_reported(self):
        path = self.record(duration=0.2)
        environment = dict(os.environ, TMPDIR=str(self.folder / "none"))
        self.expect_refused(self.run_app("replay", "--resimulate", path, env=environment),
                            "run.h5", "TMPDIR", lines=1)
        self.assertEqual(self.names_in(self.folder), ["run.h5"])


if __name__ == "__main__":
    main()
