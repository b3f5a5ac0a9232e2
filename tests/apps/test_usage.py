"""The command line: help, usage errors, unwritable paths, doctor, users and folders."""
import os
import re
import shutil

from app import BINARY, CONFIG, DONE, FREE_RUN, SOURCE, AppTest, main, ordinary_user


class Help(AppTest):
    def test_help_of_every_subcommand_runs_nothing(self):
        """test_documented.py tests that the help has what the documents use."""
        code = "".join(path.read_text() for path in (SOURCE / "apps").rglob("*.cpp"))
        self.assertEqual(re.findall(r'"([^"]*)"[^"]*->group\(""\)', code), ["--answer"], "hidden from the help")
        for command in (commands := [()]):
            with self.subTest(command):
                said = self.expect(self.run_app(*command, "--help"), DONE, "Options:\n", "--help").out
                listed = said.partition("\nSubcommands:\n")[2]
                commands += [(*command, name) for name in re.findall(r"^  ([a-z-]+) ", listed, re.M)]
        self.assertGreater(len(commands), 20)
        self.assertEqual(self.names_in(self.folder), [])

    def test_version_is_printed(self):
        self.expect(self.run_app("--version"), DONE, "wholehand ")


class BadUsage(AppTest):
    # Wrong arguments, and a word of the message that names the wrong one.
    MISTAKES = [
        ("", "--help"),
        ("bogus", "bogus"),
        ("runn", "runn"),
        ("--bogus", "--bogus"),
        ("run --bogus", "--bogus"),
        ("run extra", "extra"),
        ("run --scene", "--scene"),
        ("run --rate-hz", "--rate-hz"),
        ("run --rate-hz 1000 --rate-hz 1000", "--rate-hz"),
        ("run --engine havok", "havok"),
        ("experiment timing --engine havok", "havok"),
        ("replay", "recording"),
        ("replay a.h5 b.h5", "b.h5"),
        ("report a.h5", "--out"),
        ("replay a.h5 --report a.html --web", "--report"),
        ("experiment", "--help"),
        ("experiment walking", "walking"),
        ("experiment grasping --jittered -1", "--jittered"),
        ("experiment grasping --jittered 1.5", "--jittered"),
        ("experiment grasping --jittered many", "--jittered"),
        ("experiment timing --ticks 10", "--ticks"),
        ("experiment timing --ticks nan", "--ticks"),
        ("run --seed -1", "--seed"),
        ("run --seed 18446744073709551616", "--seed"),
        ("run --seed 1e3", "--seed"),
        ("run --level 2.5", "--level: '2.5' is not a whole number from 1 to 1000"),
        ("run --port 80.5", "--port: '80.5' is not a whole number from 0 to 65535"),
        ("experiment cocktail-bar --seeds 2.5", "--seeds: '2.5' is not a whole number from 1 to 100000"),
        ("experiment exercise --seed -1", "--seed"),
        ("experiment cocktail-bar --first-seed -1", "--first-seed"),
        ("experiment grasping --seed -1", "--seed"),
        ("validate", "files"),
        ("validate --bogus", "--bogus"),
        ("doctor now", "now"),
        ("device-host", "--name"),
        ("device-host --name desk --device d.toml", "--driver"),
        ("device-host --name desk --driver d.so --device d.toml --rate-hz 10", "--rate-hz"),
        ("run --host", "--host"),
        ("run --driver d.so --host desk", "--host"),
    ]

    def test_every_mistake_is_named_with_exit_code_2(self):
        for arguments, word in self.MISTAKES:
            with self.subTest(arguments):
                result = self.expect_refused(self.run_app(*arguments.split()), word)
                self.assertLessEqual(len(result.err.splitlines()), 2, result)
                self.assertLess(len(result.err), 200, result)  # long numbers are cut
                self.assertEqual(result.out, "")
        self.assertEqual(self.names_in(self.folder), [])

    def test_invalid_numbers_are_refused(self):
        for option in ("--rate-hz", "--duration"):
            for value in ("nan", "NaN", "inf", "-inf", "0", "-0", "-5", "1e400", "1e-320", "fast",
                          "", "1000x", "1,5", "0x"):
                with self.subTest(option=option, value=value):
                    result = self.expect_refused(
                        self.run_app(*FREE_RUN, "--simulated-clock", option, value), option, "number")
                    self.assertLessEqual(len(result.err.splitlines()), 2, result)
        self.assertEqual(self.names_in(self.folder), [])


class PlacesThatCannotBeWritten(AppTest):
    def setUp(self):
        super().setUp()
        self.write("a-file", "x")
        (self.folder / "a-folder").mkdir()

    def expect_nothing_ran(self, *arguments, place):
        before = self.names_in(self.folder)
        result = self.expect_refused(self.run_app(*arguments), place)
        self.assertNotIn("ticks", result.out, "it ran first")
        self.assertEqual(self.names_in(self.folder), before)

    def test_run_reports_an_unwritable_path_before_it_starts(self):
        for option in ("--record", "--json", "--report"):
            for place in ("a-file/below", "/proc/none/below"):
                with self.subTest(option=option, place=place):
                    self.expect_nothing_ran(*FREE_RUN, option, place, place=place)
        for option, place in (("--record", "a-folder"), ("--json", "a-folder"), ("--report", "a-file")):
            with self.subTest(option=option, place=place):
                self.expect_nothing_ran(*FREE_RUN, option, place, place=place)

    def test_special_files_are_not_replaced(self):
        # As root, a new file would replace /dev/null for the whole machine.
        os.mkfifo(self.folder / "pipe")
        os.symlink("/dev/null", self.folder / "link")
        for option in ("--record", "--json"):
            for place in ("pipe", "link"):
                with self.subTest(option=option, place=place):
                    self.expect_nothing_ran(*FREE_RUN, "--simulated-clock", option, place, place=place)
        self.assertTrue((self.folder / "pipe").is_fifo())
        self.assertTrue((self.folder / "link").is_symlink())

    def test_one_bad_path_leaves_no_folder_for_the_others(self):
        self.expect_nothing_ran(*FREE_RUN, "--record", "new/run.h5", "--report", "new/report", "--json",
                                "a-file/x.json", place="a-file/x.json")
        self.expect_nothing_ran("experiment", "timing", "--out", "new", "--json", "a-file/x.json",
                                place="a-file/x.json")

    def test_experiments_report_an_unwritable_path_before_they_start(self):
        for experiment in ("grasping", "timing"):
            with self.subTest(experiment):
                self.expect_nothing_ran("experiment", experiment, "--out", "a-file/x", place="a-file/x")
                self.expect_nothing_ran("experiment", experiment, "--out", "a-folder", "--json",
                                        "a-folder", place="a-folder")

    def test_report_reports_an_unwritable_path(self):
        recording = self.record(duration=0.2)
        self.expect_nothing_ran("report", recording, "--out", "a-file", place="a-file")
        self.expect_nothing_ran("report", recording, "--out", "a-file/x", place="a-file/x")
        self.expect_nothing_ran("replay", recording, "--report", "a-folder", place="a-folder")

    def test_folder_of_another_user_is_refused(self):
        os.chmod(self.folder, 0o755)
        os.chmod(self.folder / "a-folder", 0o555)
        for option, place in (("--record", "a-folder/run.h5"), ("--json", "a-folder/run.json"),
                              ("--report", "a-folder/report")):
            with self.subTest(option):
                tree = deployed_tree(self)
                result = self.run_app(*FREE_RUN, "--simulated-clock", option, self.folder / place,
                                      binary=tree / "build/release/wholehand", **ordinary_user())
                self.expect_refused(result, place, "denied")
                self.assertNotIn("ticks", result.out, "it ran first")


def deployed_tree(test):
    """Copies program, configuration and data into a tree that every user may read."""
    tree = test.folder / "tree"
    if not tree.exists():
        (tree / "build/release").mkdir(parents=True)
        shutil.copy(BINARY, tree / "build/release/wholehand")
        shutil.copytree(CONFIG, tree / "config")
        shutil.copytree(SOURCE / "data", tree / "data")
        (tree / "web/dist").mkdir(parents=True)
        for page in ("report.html", "charts.html"):
            shutil.copy(SOURCE / "web/dist" / page, tree / "web/dist")
        for path in [test.folder, tree, *tree.rglob("*")]:
            path.chmod(0o755)
    return tree


class UsersAndFolders(AppTest):
    def test_ordinary_user_in_another_folder_gets_all_three_files(self):
        binary = deployed_tree(self) / "build/release/wholehand"
        home = self.folder / "home"
        home.mkdir()
        if os.geteuid() == 0:
            os.chown(home, 65534, 65534)
        self.expect(self.run_app(*FREE_RUN, "--duration", "0.5", binary=binary, cwd=home,
                                 **ordinary_user()), DONE, "Done after")
        (run,) = (home / "out").iterdir()
        self.assertEqual(self.names_in(run),
                         ["recording.h5", "report", "report/index.html", "run.json"])
        for path in run.rglob("*"):
            self.assertNotEqual(path.stat().st_uid, 0)
        self.expect(self.run_app("replay", "--resimulate", run / "recording.h5", binary=binary,
                                 cwd=home, **ordinary_user()), DONE, "every bit the same")

    def test_doctor_works_for_an_ordinary_user(self):
        binary = deployed_tree(self) / "build/release/wholehand"
        self.expect_verdict(self.run_app("doctor", binary=binary, cwd="/", **ordinary_user()))

    def test_doctor_prints_its_verdict(self):
        self.expect_verdict(self.run_app("doctor"))
        self.assertEqual(self.names_in(self.folder), [])

    def expect_verdict(self, result):
        last = result.out.strip().splitlines()[-1]
        self.assertRegex(last, "^This machine (may|must not) drive a device")
        self.assertEqual(result.code, 0 if "may drive" in last else 1, result.out)
        self.assertRegex(last, r"(at most|up to) \d+ µs late \(p99.9 \d+ µs; allowed is half a period, 500 µs\)"
                               "|real-time priority is not granted|not PREEMPT_RT")
        lines = result.out.splitlines()
        for number, line in enumerate(lines):  # each line with a problem has a remedy
            if line.startswith("  ! "):
                following = [l for l in lines[number + 1:] if not l.startswith("      ") or "→" in l]
                self.assertIn("→", following[0] if following else "", result.out)


if __name__ == "__main__":
    main()
