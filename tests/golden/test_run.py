"""Tests of the runner: the errors that it must find, and the changes that it must accept. test_run.py BUILD"""
import copy
import json
import pathlib
import subprocess
import sys
import tempfile
import unittest

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parent))
import adapters  # noqa: E402
import forms  # noqa: E402
import run  # noqa: E402

SCHEMA = (run.ROOT / "protocol/wholehand.fbs").read_text(encoding="utf-8")


class OfAnotherSchema(run.Judge):
    """The judge with a changed schema."""

    def __init__(self, test, text):
        folder = pathlib.Path(tempfile.mkdtemp(prefix="wholehand-test-"))
        test.addCleanup(subprocess.run, ["rm", "-rf", folder])
        (folder / "wholehand.fbs").write_text(text, encoding="utf-8")
        subprocess.run(["flatc", "--binary", "--schema", "-o", folder, folder / "wholehand.fbs"], check=True)
        self.folder, self.program, self.compiled = folder, BUILD / "golden_judge", folder / "wholehand.bfbs"
        self.schema = forms.Schema(self.program, self.compiled)


class Schemas(unittest.TestCase):
    def failures_with(self, before, after):
        self.assertIn(before, SCHEMA)
        failures = run.Failures()
        run.check_messages(OfAnotherSchema(self, SCHEMA.replace(before, after)), run.goldens("messages"), failures)
        return failures.all

    def test_moved_field_is_found(self):
        failures = self.failures_with("missed_deadlines: ulong;\n  dropped_records: ulong;",
                                      "dropped_records: ulong;\n  missed_deadlines: ulong;")
        self.assertTrue(any("program_state: what is out there is read otherwise" in failure for failure in failures), failures)

    def test_renumbered_field_is_found(self):
        failures = self.failures_with("  accepted: bool;\n", "  new_one: bool;\n  accepted: bool;\n")
        self.assertTrue(any(failure.startswith("program_reply:") for failure in failures), failures)

    def test_new_field_at_the_end_is_allowed(self):
        self.assertEqual(self.failures_with("  items: [RefusedItem];", "  items: [RefusedItem];\n  new_one: [string];\n"), [])

    def test_new_table_needs_no_change_of_the_runner(self):
        text = SCHEMA.replace("union Order {", "struct Grip { at_m: Vec3; part: HandPart; since: long; }\n"
                              "table NewOrder { body: Body; grips: [Grip]; names: [string]; first: Grip; share: double = 0.5; }\n"
                              "union Order {").replace("OpenVisit, CloseVisit\n", "OpenVisit, CloseVisit, NewOrder\n")
        judge = OfAnotherSchema(self, text)
        for variant in ("full", "extreme"):
            form = judge.schema.payload_of("NewOrder")(judge.schema.example("NewOrder", variant))
            file = judge.folder / "spawn.bin"
            file.write_bytes(judge.schema.encode(form))
            judged, = judge.messages([file])
            self.assertEqual(judged.get("form"), {"schema_version": 1, **form})
        failures = run.Failures()
        run.check_coverage(judge.schema, run.read_goldens(JUDGE), failures)
        self.assertEqual([failure for failure in failures.all if "has no golden message" in failure],
                         ["NewOrder has no golden message; make some: /usr/bin/python3 tests/golden/make.py --missing"])

    def test_messages_of_an_older_version_must_be_refused(self):
        class Risen:
            schema = type("Schema", (), {"version": 2})

            def messages(self, paths):
                return [self.answer for _ in paths]

        for answer, found in (({"refused": "version", "program": {}}, False), ({"form": {}, "program": {}}, True)):
            judge, failures = Risen(), run.Failures()
            judge.answer = answer
            run.check_messages(judge, [g for g in run.goldens("messages") if "version" in g.entry], failures)
            self.assertEqual(bool(failures.all), found)


class Clients(unittest.TestCase):
    """Every error of a client must be found."""

    def setUp(self):
        self.schema = JUDGE.schema
        self.goldens = {golden.name: golden for golden in run.read_goldens(JUDGE)}
        self.failures = run.Failures()

    def read(self, name, got, client=adapters.Python):
        run.check_read(client(run.ROOT, BUILD), self.goldens[name], got, self.schema, self.failures)
        return self.failures.all

    def payload(self, name):
        return copy.deepcopy(self.goldens[name].form["payload"])

    def test_correctly_read_message_passes(self):
        self.assertEqual(self.read("program_state", {"payload": self.payload("program_state")}), [])

    def test_wrong_bit_of_a_value_is_found(self):
        payload = self.payload("program_state")
        payload["WorldState"]["values"][1] = "3e7ad7f29abcaf49"
        self.assertRegex(self.read("program_state", {"payload": payload})[0], r"values\[1\] is '3e7ad7f29abcaf49'")

    def test_missing_field_is_found(self):
        payload = self.payload("program_state")
        del payload["WorldState"]["links"]
        self.assertRegex(self.read("program_state", {"payload": payload})[0], "links is missing")

    def test_wrong_field_of_a_client_that_keeps_only_some_is_found(self):
        payload = self.payload("program_state")
        del payload["WorldState"]["links"]  # the addon does not keep the links
        self.assertEqual(self.read("program_state", {"payload": payload}, adapters.Godot), [])
        payload["WorldState"]["tick"] = "0000001cbe991a15"
        self.assertRegex(self.read("program_state", {"payload": payload}, adapters.Godot)[0], "tick.is '0000001cbe991a15'")

    def test_undetected_flaw_is_found(self):
        self.assertRegex(self.read("flaw_version_65535", {"payload": {}})[0], "expected: refused .version")
        self.assertRegex(self.read("flaw_cut_20", {"payload": {}}, adapters.Godot)[-1], "expected: refused .damaged")

    def test_wrong_reason_is_found(self):
        self.assertRegex(self.read("flaw_version_65535", {"refused": "payload"})[0], "reason: .*'payload', expected 'version'")

    def test_unread_payload_is_found(self):
        self.assertNotEqual(self.read("program_reply", {"unread": True}), [])

    def test_unwritten_order_is_found(self):
        run.check_written(adapters.Python(run.ROOT, BUILD), self.goldens["arm_full"], None, {}, self.failures)
        self.assertEqual(self.failures.all, ["python has to write Arm"])

    def test_escaped_exception_or_missing_answer_is_found(self):
        with tempfile.TemporaryDirectory(prefix="wholehand-test-") as folder:
            work = pathlib.Path(folder)
            for name, read in (("cut_1_0", {"escaped": "KeyError()"}), ("cut_1_1", None), ("cut_1_2", {"refused": ""}),
                               ("cut_1_3", {"payload": {}}), ("cut_1_4", {"unread": True})):
                run.check_survived(adapters.Python, name, read, b"bytes", work, self.failures)
            self.assertEqual({path.name for path in work.iterdir()}, {"cut_1_0.bin", "cut_1_1.bin"})
        self.assertEqual(len(self.failures.all), 2)
        self.assertIn("python reads cut_1_0: {'escaped': 'KeyError()'}", self.failures.all[0])

    def test_mutations_change_messages_and_repeat_with_their_seed(self):
        made = dict(run.mutated(self.goldens.values(), 700, 7))
        self.assertEqual(made, dict(run.mutated(self.goldens.values(), 700, 7)))
        whole = {golden.bytes for golden in self.goldens.values()}
        for mutation in run.MUTATIONS:
            changed = [data not in whole for name, data in made.items() if name.startswith(mutation.__name__)]
            self.assertGreater(sum(changed), 0.5 * len(changed), mutation.__name__)


class Files(unittest.TestCase):
    def make(self, *arguments):
        """What make.py prints, read as JSON."""
        return json.loads(subprocess.run([sys.executable, "-B", run.HERE / "make.py", "--build", BUILD, *arguments],
                                         text=True, capture_output=True, check=True).stdout)

    def test_existing_file_is_not_overwritten(self):
        kept = (run.GOLDEN / "messages/reply.bin").read_bytes()
        with tempfile.TemporaryDirectory() as folder:
            form = pathlib.Path(folder) / "reply.json"
            form.write_text(json.dumps({"about": "shown", **self.make("--show", "reply")}))
            made = subprocess.run([sys.executable, "-B", run.HERE / "make.py", "--build", BUILD, form], text=True,
                                  capture_output=True)
        self.assertEqual(made.returncode, 1)
        self.assertIn("reply.bin exists and is not written again: give the new message another name", made.stderr)
        self.assertEqual((run.GOLDEN / "messages/reply.bin").read_bytes(), kept)

    def test_non_canonical_form_is_refused(self):
        with tempfile.TemporaryDirectory(prefix="wholehand-test-") as folder:
            file = pathlib.Path(folder) / "not_canonical.json"
            file.write_text(json.dumps({"about": "a default that is written", "form": {"payload": {"Reply": {"command": 0}}}}))
            made = subprocess.run([sys.executable, "-B", run.HERE / "make.py", "--build", BUILD, file], text=True,
                                  capture_output=True)
        self.assertEqual(made.returncode, 1)
        self.assertIn("not_canonical: the form is not canonical", made.stderr)


if __name__ == "__main__":
    if len(sys.argv) < 2:
        sys.exit(__doc__)
    BUILD = pathlib.Path(sys.argv[1]).resolve()
    JUDGE = run.Judge(BUILD)
    unittest.main(argv=[sys.argv[0], *sys.argv[2:]])
