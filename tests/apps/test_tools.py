"""`wholehand NAME` hands commands over to wholehand-tools, and refuses one of another version by name."""
import shutil
import subprocess

from app import BAD_INPUT, BINARY, DONE, SOURCE, AppTest, main

FAKE = "#!/bin/sh\nif [ \"$1\" = --version ]; then echo 'wholehand {version}'; else echo \"fake $*\"; fi\n"


class Tools(AppTest):
    def setUp(self):
        super().setUp()
        self.version = self.expect(self.run_app("--version"), DONE).out.split(" ", 1)[1].strip()
        self.bin = self.folder / "checkout/build/release"
        self.bin.mkdir(parents=True)
        shutil.copy(BINARY, self.bin / "wholehand")

    def put_tools(self, version, at=None):
        file = at or self.bin / "wholehand-tools"
        file.write_text(FAKE.format(version=version))
        file.chmod(0o755)

    def run_copy(self, *arguments):
        return self.run_app(*arguments, binary=self.bin / "wholehand")

    def make_checkout(self, version):
        """A checkout whose script builds tools of this version."""
        (self.bin / "CMakeCache.txt").write_text(f"CMAKE_HOME_DIRECTORY:INTERNAL={self.folder}/checkout\n")
        scripts = self.folder / "checkout/scripts"
        scripts.mkdir()
        self.put_tools(version, self.folder / "built")
        (scripts / "build_tools.sh").write_text(f"echo building >&2\ncp {self.folder}/built \"$1/wholehand-tools\"\n")

    def test_help_lists_the_commands_of_both_programs(self):
        said = self.expect(self.run_app("--help"), DONE).out
        for command in ("run", "replay", "report", "doctor", "validate", "device-host", "device", "certify",
                        "experiment", "sweep", "decompose"):
            self.assertRegex(said, rf"(?m)^  {command} ")

    def test_a_command_is_handed_over_with_its_words(self):
        self.put_tools(self.version)
        self.assertEqual(self.expect(self.run_copy("certify", "--json", "a b.json"), DONE).out, "fake certify --json a b.json\n")

    def test_a_missing_program_is_named_with_its_remedy(self):
        ended = self.run_copy("sweep", "--help")
        self.assertEqual(ended.code, BAD_INPUT)
        self.assertIn(f"{self.bin}/wholehand-tools", ended.err)
        self.assertIn("is not there", ended.err)
        self.assertIn("install both programs from one package or build", ended.err)

    def test_a_program_of_another_version_is_refused_by_name(self):
        self.put_tools("0.0.9 (abc)")
        ended = self.run_copy("certify")
        self.assertEqual(ended.code, BAD_INPUT)
        self.assertIn(f"is wholehand 0.0.9 (abc), but this is wholehand {self.version}", ended.err)

    def test_in_a_checkout_it_is_built_first(self):
        self.make_checkout(self.version)
        ended = self.expect(self.run_copy("decompose", "x"), DONE)
        self.assertEqual(ended.out, "fake decompose x\n")
        self.assertIn("building", ended.err)

    def test_a_program_built_from_other_sources_is_refused(self):
        self.make_checkout("0.0.9 (abc)")
        ended = self.run_copy("certify")
        self.assertEqual(ended.code, BAD_INPUT)
        self.assertIn("the sources have changed since this program was built", ended.err)

    def test_nothing_is_built_beside_a_running_loop(self):
        self.make_checkout(self.version)
        run = subprocess.Popen([self.bin / "wholehand", "run", "--no-web", "--duration", "60"], cwd=SOURCE,
                               stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
        self.addCleanup(run.wait)
        self.addCleanup(run.kill)
        ended = self.run_copy("certify")
        self.assertEqual(ended.code, BAD_INPUT)
        self.assertIn("nothing is built beside a running loop", ended.err)
        self.assertIn(f"end the run (process {run.pid})", ended.err)
        self.assertFalse((self.bin / "wholehand-tools").exists())


if __name__ == "__main__":
    main()
