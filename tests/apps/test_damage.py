"""Damaged, missing or removed files are always reported."""
import json
import os
import resource
import shutil
import signal
import subprocess
import sys

import h5py
import numpy

from app import BAD_INPUT, BINARY, CONFIG, DONE, FREE_RUN, HANG_S, NOT_WHOLE, AppTest, corrupt_chunk, lose_ticks, main

FAILED = 4


class DamagedRecording(AppTest):
    def commands(self, path):
        return (["replay", "--speed", "1000", path], ["replay", "--resimulate", path])

    def test_corrupted_chunk_is_reported_by_every_command_that_reads_it(self):
        path = self.record(duration=2.0)
        with h5py.File(path, "r") as f:
            ticks = len(f["ticks/tick"])
        first = corrupt_chunk(path, "ticks/rendered", 1) + 1
        for arguments, code in zip(self.commands(path), (NOT_WHOLE, BAD_INPUT)):
            with self.subTest(" ".join(map(str, arguments))):
                result = self.expect(self.run_app(*arguments), code)
                for text in ("run.h5", f"tick {first} of {ticks} cannot be read", "copy it again"):
                    self.assertIn(text, result.err)
                self.assertNotIn("the same", result.out)
        # The chunks before and after it are shown: a line for each 0.1 s, none for the damaged chunk of a second.
        lines = self.run_app(*self.commands(path)[0]).out.splitlines()[1:]
        shown = [round(10 * float(line.split()[0])) for line in lines if "missing" not in line]
        self.assertEqual(shown, [tenth for tenth in range((ticks + 99) // 100) if not 10 <= tenth < 20])

    def test_measures_of_an_incomplete_recording_are_marked(self):
        path = self.record(duration=2.0)
        def complete():
            return json.loads(self.expect(self.run_app("measures", path), DONE).out)["recording"]["complete"]
        self.assertIs(complete(), True)
        corrupt_chunk(path, "ticks/tick", -1)  # the last ticks: no later one shows that they are missing
        self.assertIs(complete(), False)

    def test_gap_is_reported_and_later_ticks_are_read(self):
        path = self.record(duration=2.0)
        ticks = lose_ticks(path, 500, 1200)
        result = self.expect(self.run_app("replay", "--speed", "1000", path), NOT_WHOLE,
                             f"{ticks - 700} ticks", "700 ticks, 0.700 s, are missing", "700 ticks are missing")
        last = float(result.out.splitlines()[-1].split()[0])
        self.assertAlmostEqual(last, (ticks - 1) * 1e-3, delta=0.11)  # a line is printed for each 0.1 s
        self.expect_refused(self.run_app("replay", "--resimulate", path), "tick 500 is missing")

    def test_impossible_metadata_is_refused(self):
        path = self.record(duration=0.2)
        whole = path.read_bytes()
        for key, value, text in (("armed_position", numpy.zeros(20), "armed position"),
                                 ("period_s", 1e-300, "period of 1e-300 s"),
                                 ("period_s", 1e300, "period of 1e+300 s"),
                                 ("period_s", float("nan"), "period of nan s")):
            path.write_bytes(whole)
            with h5py.File(path, "r+", libver="latest") as f:
                del f["meta"].attrs[key]
                f["meta"].attrs[key] = value
            for arguments in self.commands(path):
                with self.subTest(f"{key} {value} {arguments[0]}"):
                    self.expect_refused(self.run_app(*arguments), "run.h5", text, lines=1)


class UntrustedFile(AppTest):
    """Files, names and numbers from an untrusted source."""

    def test_toml_beyond_bounds_is_refused_at_once(self):
        deep = "a" + ".a" * 100000 + " = 1\n"
        for name, text, said in (("dotted", deep, "a key of more than 32 parts"),
                                 ("header", "[" + deep[:-5] + "]\n", "a key of more than 32 parts"),
                                 ("arrays", "a = " + "[" * 100000, "more than 32 nested levels"),
                                 ("inline", "a = " + "{a=" * 100000, "more than 32 nested levels"),
                                 ("keys", "".join(f"k{i} = 1\n" for i in range(100000)), "more than 12000 keys"),
                                 ("tables", "[[axes]]\n" * 100000, "more than 1200 tables"),
                                 ("large", "#" * (5 << 20), "larger than 4 MB")):
            self.write(name + ".toml", text)
            with self.subTest(name):
                self.expect_refused(self.run_app("validate", name + ".toml"), name + ".toml", said, lines=1)
        # Similar text in quotes and comments is accepted.
        device = (CONFIG / "devices/lambda-pride.toml").read_text()
        self.write("quoted.toml", device + "# " + "[" * 1000 + "." * 1000 + "\n")
        self.expect(self.run_app("validate", "quoted.toml"), DONE)

    def test_at_most_20_faults_of_a_file_are_listed(self):
        body = '[[bodies]]\nname = "b"\nshape = "cone"\n'
        self.write("scene.toml", 'kind = "scene"\nversion = 1\nname = "many"\n' + body * 300)
        result = self.expect_refused(self.run_app("validate", "scene.toml"), "more faults; correct these first", lines=21)
        self.assertRegex(result.err.splitlines()[-1], r"has \d{3,} more faults")

    def test_untrusted_text_does_not_control_the_terminal(self):
        evil = "x\x1b[2J\x9b2J\u202egnp\x07"
        scene = (CONFIG / "scenes/four-shapes.toml").read_text()
        self.write("name.toml", scene.replace('name = "cube"', 'name = "cube\\u001b[2J\\u202e"'))
        self.write("key.toml", scene + f'\n"{chr(92)}u001b[2J" = 1\n')
        path = self.record(duration=0.2)
        whole = path.read_bytes()
        with h5py.File(path, "r+", libver="latest") as f:
            del f["meta"].attrs["title"]
            f["meta"].attrs["title"] = numpy.bytes_(evil.encode())
        shutil.copy(path, self.folder / (evil + ".h5"))
        os.rename(path, self.folder / "title.h5")
        (self.folder / (evil + "2.h5")).write_bytes(whole)
        for arguments in (["validate", "name.toml"], ["validate", "key.toml"], ["validate", evil + ".toml"],
                          ["replay", "title.h5"], ["replay", evil + ".h5"], ["replay", evil + "2.h5", "--resimulate"],
                          ["run", "--scene", "name.toml", "--simulated-clock"],
                          [*FREE_RUN, "--simulated-clock", "--duration", "0.1", "--record", evil + "3.h5"],
                          [evil], ["run", "--engine", evil], ["run", "--rate-hz", evil], ["run", "--" + evil],
                          ["device", "inspect", evil], ["sweep", evil], ["validate", "a.toml", "--" + evil]):
            with self.subTest(" ".join(map(str, arguments))):
                result = self.run_app(*arguments)
                said = result.out + result.err
                self.assertTrue(said)
                for mark in evil[1:2] + evil[5:6] + evil[8:9] + evil[12:13]:
                    self.assertNotIn(mark, said)

    def test_extreme_numbers_are_handled(self):
        device = CONFIG / "devices/lambda-pride.toml"
        gains = (CONFIG / "rendering/lambda-pride.toml").read_text()
        for key in ("k_pm_n_m", "k_dm_n_s_m"):
            for number in ("5e-324", "1e-310", "1e-300"):
                at = gains.index(key + " = ")
                self.write("gains.toml", gains[:at] + f"{key} = {number} # " + gains[at + len(key) + 3:])
                for arguments in (["certify", "--device", device, "--rendering", "gains.toml"],
                                  ["validate", "gains.toml"],
                                  [*FREE_RUN, "--simulated-clock", "--duration", "0.1", "--rendering", "gains.toml"]):
                    with self.subTest(f"{key} {number} {arguments[0]}"):
                        self.assertIn(self.run_app(*arguments).code, (DONE, 1, BAD_INPUT))


class OwnFiles(AppTest):
    def test_run_replaces_no_file_but_a_recording(self):
        motion = self.folder / "motion.csv"
        shutil.copy(FREE_RUN[2], motion)
        text = self.write("thesis.txt", "years of work\n")
        run = ("run", "--motion", motion, "--simulated-clock", "--duration", "0.1")
        (self.folder / "other.csv").symlink_to(motion)
        for output, said in ((["--record", motion], "is read by this run"), (["--json", "./motion.csv"], "is read by"),
                             (["--record", "other.csv"], "not a regular file"),
                             (["--record", "a.h5", "--json", "./a.h5"], "is named for two outputs"),
                             (["--record", text], "holds something else than a recording")):
            with self.subTest(str(output)):
                before = self.names_in(self.folder)
                self.expect_refused(self.run_app(*run, *output), said)
                self.assertEqual(self.names_in(self.folder), before)
        self.assertEqual(text.read_text(), "years of work\n")
        for _ in range(2):
            self.expect(self.run_app(*run, "--record", "again.h5"), DONE)

    def test_second_program_on_one_recording_is_refused(self):
        first = self.start_app(*FREE_RUN, "--duration", "60", "--record", "a.h5", "--no-rehearsal")
        self.wait_until_it_renders(first)
        self.expect_refused(self.run_app(*FREE_RUN, "--simulated-clock", "--duration", "0.1", "--record", "a.h5"),
                            "a.h5", "is open in another program")
        first.send_signal(signal.SIGINT)
        first.wait(30)
        self.expect_same_when_run_again(self.folder / "a.h5")

    def test_foreign_origin_needs_a_token(self):
        for origin in ("https://clinic.example", "http://127.evil.example", "http://[2001:db8::1]:80"):
            self.expect_refused(self.run_app("run", "--port", "0", "--origin", origin), "--origin", "--token")


class TakenAway(AppTest):
    def test_folders_in_the_working_directory_are_not_used_as_the_programs_own(self):
        for name in ("hands/adult-median-right.toml", "devices/lambda-pride.toml", "exercises/cocktail-bar.toml"):
            self.write("config/" + name, "kind = 'nothing of the program'\n")
        self.expect(self.run_app(*FREE_RUN, "--simulated-clock", "--duration", "0.1", "--json", "run.json"), DONE)
        self.expect(self.run_app("run", "--exercise", "cocktail-bar", "--simulated-clock", "--duration", "0.1",
                                 "--json", "bar.json"), DONE)

    def test_path_that_is_not_utf8_is_accepted(self):
        name = os.fsdecode(b"r\xff\xfe")
        self.expect(self.run_app(*FREE_RUN, "--simulated-clock", "--duration", "0.1", "--record", name + ".h5",
                                 "--json", name + ".json"), DONE)
        json.loads((self.folder / (name + ".json")).read_bytes())
        self.expect(self.run_app("validate", name + ".toml"), BAD_INPUT)

    def test_full_standard_output_is_an_error(self):
        path = self.record(duration=0.2)
        device = BINARY.parents[2] / "config/devices/lambda-pride.toml"
        for arguments in (["replay", "--speed", "1000", path], ["replay", "--resimulate", path],
                          ["validate", device]):
            with self.subTest(arguments[0]), open("/dev/full", "w") as full:
                done = subprocess.run([BINARY, *arguments], cwd=self.folder, stdout=full, stderr=subprocess.PIPE,
                                      text=True, timeout=HANG_S)
                self.assertEqual(done.returncode, BAD_INPUT)
                self.assertIn("standard output: cannot be written: No space left on device", done.stderr)

    def test_removed_folder_and_too_little_memory_are_reported_in_a_sentence(self):
        gone = self.folder / "gone"
        gone.mkdir()
        script = "import os, sys, shutil; os.chdir(sys.argv[1]); shutil.rmtree(sys.argv[1]); os.execv(sys.argv[2], sys.argv[2:])"
        run = [*map(str, FREE_RUN), "--simulated-clock", "--duration", "0.1"]
        done = subprocess.run([sys.executable, "-c", script, gone, BINARY, *run], text=True, capture_output=True,
                              timeout=HANG_S)
        self.assertIn(done.returncode, (BAD_INPUT, FAILED), done.stderr)
        self.assertIn("wholehand: ", done.stderr)

        def limit(mib):
            return lambda: resource.setrlimit(resource.RLIMIT_AS, (mib << 20, mib << 20))
        for mib in (*range(50, 66, 2), 100, 150, 200, 250, 300):  # below 60, Bullet's allocator once wrote to 0
            begins = subprocess.run([BINARY, "--version"], capture_output=True, timeout=HANG_S, preexec_fn=limit(mib))
            if begins.returncode != DONE:
                continue  # the loader, or C++ code before main(), had no memory
            with self.subTest(mib=mib):
                done = subprocess.run([BINARY, *run, "--json", "a.json"], cwd=self.folder, text=True,
                                      capture_output=True, timeout=HANG_S, preexec_fn=limit(mib))
                self.assertIn(done.returncode, (DONE, BAD_INPUT, FAILED), done.stderr)
                self.assertNotIn("terminate", done.stderr)
                if done.returncode == FAILED:
                    self.assertRegex(done.stderr, "there is not enough memory|a thread could not be started")


if __name__ == "__main__":
    main()
