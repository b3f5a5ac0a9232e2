"""`wholehand run --clinic`: a visit from the first start to its result; the end of a process loses nothing that was
answered. web/tests/browser/clinic_checks.mjs and tests/clinic test the rest."""
import json
import os
import pathlib
import re
import shlex
import signal
import time
import urllib.error
import urllib.request
import uuid

import client
from app import BINARY, DONE, FULL, HANG_S, SOURCE, PacedTest, main

TICK, RUN_STATE = 1, 4   # fields of WorldState
RENDERING, STOPPED = 1, 3
PHRASE, PIN = "a phrase of the clinic", "4711"
CANARY = "Zzyzx Quillfeather"
KILLS = 100 if FULL else 4
PLAN = [{"exercise": "cocktail-bar", "level": 1, "minutes": 5, "help": "full", "parameters": {}},
        {"exercise": "squeeze-to-level", "level": 1, "minutes": 5, "help": "some", "parameters": {}}]

# The requests and commands of docs/clinic.md, which are sent and run unchanged.
PIECES = re.findall(r"^```\w*\n(.*?)^```", (SOURCE / "docs/clinic.md").read_text(), re.S | re.M)


def filled(text):
    """The first JSON value in a text of docs/clinic.md, in which dots stand for omitted parts."""
    return json.JSONDecoder().raw_decode(text.replace("[…]", "[]").replace(", …}", "}").replace("…", "0"))[0]


def requests_of(piece):
    """(method, path, body, answer) of each request of a piece of docs/clinic.md; the answer is after → or below."""
    for said in re.split(r"\n(?=[A-Z])", piece):
        method, path = said.split()[:2]
        body, answer = re.match(r"\S+ \S+ +(\{.*)", said), re.search(r"(?:→ |\n  )(\{.*)", said, re.S)
        yield method, path.removeprefix("/api"), body and filled(body[1]), answer and filled(answer[1])


class Clinic(PacedTest):
    def start(self):
        self.run_ = self.start_app("run", "--clinic", "clinic", "--port", 0, "--no-rehearsal")
        self.url = self.run_.stdout.readline().strip().rstrip("/")
        self.token = None
        self.wait_for_records()

    def wait_for_records(self):
        self.wait_until(self.run_, lambda: self.port() != 0 and self.state() is not None)

    def port(self):
        with urllib.request.urlopen(self.url + "/api/clinic", timeout=HANG_S) as answer:
            return json.load(answer)["port"]

    def state(self):
        try:
            state = self.ask("GET", "/state")
            return state if state["station"]["heard"] else None
        except (OSError, ConnectionError):
            return None

    def ask(self, method, path, body=None, key=None):
        """The answer, also if it is a refusal."""
        data = None if body is None else json.dumps(body).encode()
        request = urllib.request.Request(f"http://127.0.0.1:{self.port()}/api{path}", method=method, data=data)
        request.add_header("Origin", self.url)
        if self.token:
            request.add_header("Authorization", "Bearer " + self.token)
        if method != "GET":
            request.add_header("Idempotency-Key", key or str(uuid.uuid4()))
        try:
            with urllib.request.urlopen(request, timeout=HANG_S) as answer:
                return json.load(answer)
        except urllib.error.HTTPError as refused:
            return json.load(refused)

    def done(self, method, path, body=None):
        answer = self.ask(method, path, body)
        self.assertNotIn("refused", answer, f"{method} {path}")
        return answer

    def begin_clinic(self):
        tile = {"name": "A. Keller", "colour": "#0d6b5a", "pin": PIN}
        self.token = self.done("POST", "/init", {"pass_phrase": PHRASE, "tile": tile})["token"]

    def sign_in(self):
        self.token = None
        self.done("POST", "/unlock", {"pass_phrase": PHRASE})
        self.token = self.done("POST", "/sign_in", {"account": 1, "pin": PIN})["token"]

    def add_patient(self, code="P-014", length_m=0.163):
        return self.done("POST", "/patients", {
            "name": CANARY, "code": code, "born": "1956-03-02", "number": "Quillfeather-77", "side": "right",
            "hands": {"right": {"length_m": length_m, "breadth_m": 0.071}}, "preset": "gentle", "parameters": {},
            "warnings": "Quillfeather: shoulder", "plan": PLAN})

    def begin_visit(self, patient):
        return self.done("POST", f"/patients/{patient['id']}/visits", {"side": "right", "plan": PLAN})

    def play(self, seconds):
        """Arms at the console, and stops after so many seconds of rendering."""
        page = client.Page(int(self.url.split(":")[2]), role="therapist")
        page.hold_controls()
        self.wait_until(self.run_, lambda: page.state is not None)
        accepted, reason = page.arm(page.state.number(client.ENDINGS, "I"))
        self.assertTrue(accepted, reason)
        self.wait_until(self.run_, lambda: page.state.number(RUN_STATE, "b") == RENDERING
                        and page.state.number(TICK, "Q") >= 1000 * seconds)
        return page

    def stop(self, page):
        self.assertTrue(page.answer(page.say(client.STOP))[0])
        self.wait_until(self.run_, lambda: page.state.number(RUN_STATE, "b") == STOPPED)
        page.close()

    def looked_at(self, patient, count):
        """The patient's trials, once none waits to be measured."""
        def trials():
            visits = self.done("GET", f"/patients/{patient['id']}")["visits"]
            return [trial for visit in visits for trial in visit["trials"]]
        self.wait_until(self.run_, lambda: len(trials()) >= count and all(t["state"] != "waiting" for t in trials()))
        return trials()

    def measured(self, patient, count):
        trials = self.looked_at(patient, count)
        self.assertEqual({trial["state"] for trial in trials}, {"measured"}, trials)
        return trials

    def kill_records(self):
        """Kills the records process, which is a child of the program."""
        children = pathlib.Path(f"/proc/{self.run_.pid}/task/{self.run_.pid}/children")
        found = [int(pid) for task in children.parents[1].glob("*/children") for pid in task.read_text().split()
                 if "wholehand-clinic" in pathlib.Path(f"/proc/{pid}/cmdline").read_text()]
        for pid in found:
            os.kill(pid, signal.SIGKILL)
        return found

    def test_visit_has_limits_number_and_result_and_names_stay_in_the_records(self):
        self.start()
        self.begin_clinic()
        patient = self.add_patient()
        visit = self.begin_visit(patient)
        page = self.play(1.0)
        refused = self.ask("POST", f"/visits/{visit['id']}/item", {"item": 1})
        self.assertEqual(refused["refused"], "station", "the next item while somebody is moved")
        self.stop(page)
        self.done("POST", f"/visits/{visit['id']}/pain", {"when": "before", "value": 0})
        self.done("POST", f"/visits/{visit['id']}/notes", {"kind": "text", "text": CANARY, "at_us": 1})
        self.done("POST", f"/visits/{visit['id']}/item", {"item": 1})
        self.stop(self.play(0.5))
        self.done("POST", f"/visits/{visit['id']}/finish", {"state": "done"})
        trials = self.measured(patient, 2)
        self.assertEqual([(t["item"], t["exercise"]) for t in trials], [(0, "cocktail-bar"), (1, "squeeze-to-level")])
        kept = self.done("GET", f"/patients/{patient['id']}")
        self.assertEqual(kept["name"], CANARY)
        self.assertEqual(kept["visits"][0]["pain_before"], 0)  # answered
        self.assertIsNone(kept["visits"][0]["pain_after"])     # not answered
        import h5py
        for trial in trials:
            with h5py.File(self.folder / "out/recordings" / trial["recording"], locking=False) as file:
                meta = file["meta"].attrs
                self.assertEqual((int(meta["clinic_visit"]), int(meta["clinic_item"])), (visit["id"], trial["item"]))
                self.assertEqual(file["ticks/effort_limit"][0, 0], 6.0, "the gentle limit of the arm, from the first tick")
        with urllib.request.urlopen(self.url + "/metrics", timeout=HANG_S) as metrics:
            self.assertNotIn(b"Quillfeather", metrics.read())
        self.assertNotIn(b"Quillfeather", memory_of(self.run_.pid), "the loop's process has heard a name")
        said = self.expect_ended_by(self.run_, signal.SIGINT)
        self.assertNotIn("Quillfeather", said)
        with_name = [path for path in self.folder.rglob("*") if path.is_file() and b"Quillfeather" in path.read_bytes()]
        self.assertEqual(with_name, [])

    def test_settings_of_a_visit_apply_to_the_next(self):
        self.start()
        self.begin_clinic()
        patient = self.add_patient()
        visit = self.begin_visit(patient)
        page = client.Page(int(self.url.split(":")[2]), role="therapist")
        # In the first second of a visit no limit may be raised, because a console may still show the earlier visit.
        self.wait_until(self.run_, lambda: page.answer(page.say(client.SET_PARAMETER, "effort_limit_arm_n", ("d", 9.5), ("I", page.basis())))[0])
        page.close()
        changed = {"effort_limit_arm_n": 9.5}
        self.wait_until(self.run_, lambda: self.ask("GET", f"/visits/{visit['id']}")["changed"] == changed)
        self.kill_records()
        self.wait_for_records()
        self.sign_in()
        self.done("POST", f"/visits/{visit['id']}/finish", {"state": "done"})
        self.assertEqual(self.done("GET", f"/patients/{patient['id']}")["parameters"], changed)
        self.begin_visit(patient)
        self.stop(self.play(0.2))
        self.expect_ended_by(self.run_, signal.SIGINT)
        import h5py
        newest = max((self.folder / "out/recordings").glob("*.h5"))
        with h5py.File(newest, locking=False) as file:
            self.assertEqual(file["ticks/effort_limit"][0, 0], 9.5)

    def test_killed_records_process_loses_no_answered_change_and_delays_no_session(self):
        self.start()
        self.begin_clinic()
        patient = self.add_patient()
        visit = self.begin_visit(patient)
        page = self.play(0.2)
        answered = []
        for kill in range(KILLS):
            moment, n = time.monotonic() + self.random.uniform(0.0, 0.3), 0
            while time.monotonic() < moment:
                text = f"note {kill} {n}"
                self.done("POST", f"/visits/{visit['id']}/notes", {"kind": "text", "text": text, "at_us": kill})
                answered.append(text)
                n += 1
            tick = page.state.number(TICK, "Q")
            self.assertEqual(len(self.kill_records()), 1)
            self.wait_until(self.run_, lambda: page.state.number(TICK, "Q") > tick + 200)
            self.wait_for_records()
            self.sign_in()
        self.assertEqual(page.state.number(RUN_STATE, "b"), RENDERING)
        self.stop(page)
        self.done("POST", f"/visits/{visit['id']}/finish", {"state": "done"})
        kept = self.done("GET", f"/patients/{patient['id']}")["visits"][0]
        self.assertEqual([note["text"] for note in kept["notes"]], answered)
        self.assertEqual(len(self.measured(patient, 1)), 1)
        self.expect_ended_by(self.run_, signal.SIGINT)

    def test_program_killed_in_a_visit_has_every_trial_after_a_restart(self):
        self.start()
        self.begin_clinic()
        patient = self.add_patient()
        visit = self.begin_visit(patient)
        for kill in range(KILLS // 2):
            page = self.play(self.random.uniform(0.1, 2.5))
            self.run_.kill()
            self.run_.wait()
            page.open = False
            self.start()
            self.sign_in()
            trials = self.looked_at(patient, kill + 1)
            self.assertEqual(len(trials), kill + 1)
            self.assertRegex(trials[-1]["recording"], rf"visit-{visit['id']}-")
            for trial in trials:  # ticks of the first second are not in the file, but in its inputs
                self.assertTrue(trial["state"] == "measured" or "has no tick" in trial["why"], trial)
            self.done("POST", f"/visits/{visit['id']}/item", {"item": 0})  # the visit continues by a press
        self.done("POST", f"/visits/{visit['id']}/finish", {"state": "done"})
        self.expect_ended_by(self.run_, signal.SIGINT)

    def expect_keys(self, said, answer):
        self.assertNotIn("refused", answer)
        self.assertLessEqual(set(said), set(answer))

    def test_requests_for_a_visit_and_notes_are_answered_as_documented(self):
        self.start()
        (method, path, _, said), = requests_of(PIECES[0])
        answer = self.ask(method, path)
        self.expect_keys(said, answer)
        self.expect_keys(said["folder"], answer["folder"])
        self.assertEqual((answer["clinic"], answer["folder"]["empty"]), (said["clinic"], said["folder"]["empty"]))
        self.begin_clinic()
        patient = self.add_patient()
        visit = self.begin_visit(patient)
        (method, path, _, said), = requests_of(PIECES[1])
        self.expect_keys(said, self.ask(method, path.replace(str(said["id"]), str(visit["id"]))))
        for_visit, for_patient, again = requests_of(PIECES[2])
        for number, (method, path, body, said) in ((1, for_visit), (2, for_patient), (1, again)):
            own = {"visit": visit["id"], "patient": patient["id"]}
            answer = self.ask(method, f"{path[:-1]}{number}", {key: own.get(key, value) for key, value in body.items()})
            self.expect_keys(said or {}, answer)
            self.assertEqual(answer["text"], body["text"])

    def test_sessions_without_a_patient_are_assigned_as_documented(self):
        self.start()
        self.begin_clinic()
        patient = self.add_patient()
        ask, give, delete = requests_of(PIECES[3])
        for _ in range(2):
            self.stop(self.play(0.3))
        listed = lambda: self.ask(*ask[:2])["sessions"]
        self.wait_until(self.run_, lambda: [session["state"] for session in listed()] == ["measured"] * 2)
        self.expect_keys(ask[3], self.ask(*ask[:2]))
        first, second = listed()
        self.expect_keys(ask[3]["sessions"][0], first)
        self.assertEqual(set(give[2]), {"patient", "sessions"})
        visit = self.ask(*give[:2], {"patient": patient["id"], "sessions": [first["id"]]})
        self.assertEqual((visit["state"], [trial["recording"] for trial in visit["trials"]]), ("done", [first["recording"]]))
        path, _, _ = delete[1].rpartition("/")
        self.assertEqual(self.ask(delete[0], f"{path}/{second['id']}"), delete[3])

    def test_backup_is_restored(self):
        place = {"FOLDER": "clinic", "/media/stick/clinic.db": "clinic.db"}
        backup, verify, restore = ([place.get(word, word) for word in shlex.split(line, comments=True)]
                                   for line in PIECES[4].splitlines())
        self.start()
        self.begin_clinic()
        patient = self.add_patient()
        do = lambda command: self.expect(self.run_app(*command[1:], binary=BINARY.parent / command[0]), DONE)
        do(backup)
        do(verify)
        self.done("POST", f"/patients/{patient['id']}/visits", {"side": "right", "plan": PLAN})
        self.expect_ended_by(self.run_, signal.SIGINT)
        do(restore)
        self.start()
        self.sign_in()
        self.assertEqual(self.done("GET", f"/patients/{patient['id']}")["visits"], [], "as it was when it was copied")


def memory_of(pid):
    """The memory that a core dump of the program would contain."""
    held = bytearray()
    with open(f"/proc/{pid}/mem", "rb", buffering=0) as memory:
        for line in pathlib.Path(f"/proc/{pid}/maps").read_text().splitlines():
            begin, end, may = re.match(r"([0-9a-f]+)-([0-9a-f]+) (\S+)", line).groups()
            if not may.startswith("rw") or int(end, 16) - int(begin, 16) > 1 << 28:
                continue
            try:
                memory.seek(int(begin, 16))
                held += memory.read(int(end, 16) - int(begin, 16))
            except OSError:
                pass
    return bytes(held)


if __name__ == "__main__":
    main()
