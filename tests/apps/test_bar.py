"""`wholehand run` at the cocktail bar: a level played and played again, the pages' port, what is refused."""
import json
import os
import pathlib
import signal
import socket
import time
import unittest
import urllib.request

from app import BAD_INPUT, CONFIG, DONE, INTERRUPTED, AppTest, read_recording

LEVER_M = 0.08  # of fingers and thumb, config/devices/lambda-pride.toml


class Level(AppTest):
    """Level 1, played once on the simulated clock; the tests look at its recording."""

    @classmethod
    def setUpClass(cls):
        super().setUpClass()
        keeper = cls("run_level")
        keeper.setUp()
        cls.addClassCleanup(keeper.doCleanups)
        keeper.run_level()
        cls.recording = keeper.folder / "bar.h5"

    def run_level(self):
        result = self.run_app("run", "--simulated-clock", "--level", 1, "--duration", 20, "--record", "bar.h5")
        self.expect(result, DONE, "cocktail-bar, level 1", "Done after 20", "faults   none")

    def open(self):
        recording = read_recording(self.recording)
        self.addCleanup(recording.close)
        return recording

    def values(self, recording):
        names = [text.decode() for text in recording["meta"].attrs["value_names"]]
        return dict(zip(names, recording["ticks/exercise_values"][:].T))

    def test_it_is_completed(self):
        recording = self.open()
        meta, events = recording["meta"].attrs, recording["events"]
        self.assertEqual((meta["exercise"], meta["level"]), (b"cocktail-bar", 1))
        names = [text.decode() for text in meta["event_names"]]
        told = [names[event] for event in events["type"][:]]
        self.assertEqual(told[-1], "level_done", told)
        # In the order in which anybody does it.
        order = [told.index(name) for name in
                 ("approached", "engaged", "pour_began", "line_reached", "pour_ended", "step_done",
                  "drink_done", "level_done")]
        self.assertEqual(order, sorted(order), told)
        for mishap in ("overfilled", "spilt", "wrong_dispenser", "restarted"):
            self.assertNotIn(mishap, told)
        last = {name: column[-1] for name, column in self.values(recording).items()}
        self.assertEqual(last["stage"], 5)  # level done, docs/exercises.md
        # One drink of 40 ml, 6 ml of tolerance: the shipped file.
        self.assertAlmostEqual(last["poured_total_l"], 0.040, delta=0.006)
        self.assertEqual(last["spilt_l"], 0.0)
        self.assertEqual(events["value"][-1], last["score"])
        self.assertGreaterEqual(last["score"], 70)  # accuracy at least 0.8, nothing spilt: 95 · 0.8 − 0

    def test_run_again_every_bit_is_the_same(self):
        self.expect_same_when_run_again(self.recording)

    def test_volumes_add_up_in_every_tick(self):
        values = self.values(self.open())
        left = sum(column for name, column in values.items() if name.startswith("left_l/"))
        there = values["poured_total_l"] + values["spilt_l"] + left
        self.assertLess(abs(there - 0.35).max(), 1e-9)  # start_l of the only dispenser
        self.assertTrue((values["start_total_l"] == 0.35).all())
        for name in ("poured_total_l", "spilt_l"):  # nothing flows back
            self.assertTrue((values[name][1:] >= values[name][:-1]).all(), name)
        self.assertGreater(values["poured_total_l"][-1], 0.0)

    def test_what_flows_is_what_is_missing(self):
        # ∫ flow dt; a tick's flow belongs to that tick.
        values = self.values(self.open())
        self.assertAlmostEqual(values["flow_l_s"].sum() * 1e-3, values["poured_total_l"][-1], delta=1e-7)
        # Flow = l_per_s_n (squeeze − threshold) / viscosity, at most max_l_s; the file's numbers.
        flow = values["flow_l_s"]
        law = (0.0016 * (values["squeeze_n"] - 3.0)).clip(0.0, 0.02)
        self.assertGreater((flow > 0).sum(), 1000)
        self.assertLess(abs(flow - law)[flow > 0].max(), 1e-9)

    def test_wall_never_pulls(self):
        recording = self.open()
        effort, alpha = recording["ticks/exercise_effort"][:], recording["ticks/alpha"][:]
        axes = [text.decode() for text in recording["meta"].attrs["axis_names"]]
        for axis, name in enumerate(axes):
            if name in ("finger_flexion", "thumb_flexion"):
                # The fingers close towards larger angles: what resists them is negative.
                self.assertLessEqual(effort[:, axis].max(), 0.0, name)
                self.assertLess(effort[:, axis].min(), -0.01, name)  # it was felt
            else:
                self.assertFalse(effort[:, axis].any(), name)
        self.assertFalse(effort[alpha == 0.0].any())
        self.assertEqual((alpha.min(), alpha.max()), (0.0, 1.0))

    def test_wall_is_equation_15(self):
        # f_e = −α min(cap, max(0, k p + d q̇)) for p > 0: lemon, 80 N/m and 0.22 N·s/m at the tip,
        # 90 % of the axis's 0.8 N·m.
        recording = self.open()
        ticks = {name: recording["ticks/" + name][:] for name in
                 ("exercise_effort", "alpha", "wall", "wall_active", "q_m", "qd_mf")}
        axes = [text.decode() for text in recording["meta"].attrs["axis_names"]]
        for axis in (axes.index("finger_flexion"), axes.index("thumb_flexion")):
            depth = ticks["q_m"][:, axis] - ticks["wall"][:, axis]
            push = LEVER_M**2 * (80.0 * depth + 0.22 * ticks["qd_mf"][:, axis])
            expected = -ticks["alpha"] * push.clip(0.0, 0.9 * 0.8)
            expected[(depth <= 0.0) | (ticks["wall_active"][:, axis] == 0.0)] = 0.0
            self.assertLess(abs(ticks["exercise_effort"][:, axis] - expected).max(), 1e-12)

    def test_other_virtual_patient_is_another_person(self):
        def positions(seed):
            path = self.record(f"{seed}.h5", "--level", 1, "--seed", seed, duration=1.0)
            with read_recording(path) as recording:
                return recording["ticks/q_m"][:]

        first = self.open()["ticks/q_m"][:1001]
        same, other = positions(1), positions(2)
        self.assertTrue((same[:1000] == first[:1000]).all())
        self.assertTrue((same[:1000] != other[:1000]).any())


def inet_sockets(pid):
    """What a process has open towards the network: (protocol, local address, port, state), hexadecimal."""
    inodes = set()
    for descriptor in pathlib.Path(f"/proc/{pid}/fd").iterdir():
        try:
            target = os.readlink(descriptor)
        except FileNotFoundError:  # closed meanwhile
            continue
        if target.startswith("socket:["):
            inodes.add(target[len("socket:["):-1])
    found = []
    for protocol in ("tcp", "tcp6", "udp", "udp6", "raw", "raw6"):
        table = pathlib.Path(f"/proc/{pid}/net/{protocol}")
        if not table.exists():
            continue
        for line in table.read_text().splitlines()[1:]:
            fields = line.split()
            if fields[9] in inodes:
                address, port = fields[1].split(":")
                found.append((protocol, address, int(port, 16), fields[3]))
    return found


def catches(pid, number):
    """Has this process a handler for the signal?"""
    status = pathlib.Path(f"/proc/{pid}/status").read_text()
    return int(status.split("SigCgt:")[1].split()[0], 16) >> (number - 1) & 1 == 1


LISTENS = "0A"
THIS_MACHINE = "0100007F"  # 127.0.0.1 as /proc/net writes it on a little-endian machine


class Pages(AppTest):
    def start_waiting(self, *arguments):
        """The program with its pages, rendering nothing; and the address it prints first."""
        run = self.start_app("run", "--wait", "--port", 0, *arguments)
        url = run.stdout.readline().strip()
        self.assertRegex(url, r"^http://127\.0\.0\.1:\d+/$")
        return run, url

    def health(self, url):
        with urllib.request.urlopen(url + "healthz", timeout=5) as answer:
            self.assertEqual(answer.status, 200)
            return json.load(answer)

    def end(self, run, code):
        # Until it catches Ctrl-C nothing is rendered, and the signal's own end is as good.
        until = time.monotonic() + 20.0
        while not catches(run.pid, signal.SIGINT) and time.monotonic() < until:
            time.sleep(0.01)
        run.send_signal(signal.SIGINT)
        said, complained = run.communicate(timeout=20)
        self.assertEqual(run.returncode, code, said + complained)
        self.assertEqual(complained, "")

    def test_address_comes_first_and_answers_for_this_machine_only(self):
        run, url = self.start_waiting("--duration", 600)
        health = self.health(url)
        self.assertIs(health["healthy"], True)
        self.assertEqual(health["run_state"], "disarmed")  # --wait: nobody asked for it yet
        self.assertEqual(health["ticks"], 0)
        port = int(url.split(":")[2].rstrip("/"))
        self.assertIn(("tcp", THIS_MACHINE, port, LISTENS), inet_sockets(run.pid))
        listening = [s for s in inet_sockets(run.pid) if s[3] == LISTENS or not s[0].startswith("tcp")]
        self.assertEqual(len(listening), 1, listening)  # and no UDP
        self.end(run, INTERRUPTED)  # before its 600 s were over

    def test_ctrl_c_is_how_an_endless_run_ends(self):
        run, _ = self.start_waiting()
        self.end(run, DONE)
        self.assertEqual(self.names_in(self.folder), [])  # nothing was armed, nothing was written

    def test_waiting_ends_by_itself(self):
        began = time.monotonic()
        run, _ = self.start_waiting("--duration", 1)
        said, complained = run.communicate(timeout=20)
        self.assertEqual(run.returncode, DONE, said + complained)
        self.assertGreater(time.monotonic() - began, 1.0)

    def test_ctrl_c_while_it_renders_ramps_and_closes_the_recording(self):
        run = self.start_app("run", "--port", 0, "--duration", 600, "--record", "run.h5")
        url = run.stdout.readline().strip()
        until = time.monotonic() + 20.0
        while self.health(url)["ticks"] < 1000 and time.monotonic() < until:
            time.sleep(0.1)
        self.assertEqual(self.health(url)["run_state"], "rendering")
        self.end(run, INTERRUPTED)
        with read_recording(self.folder / "run.h5") as recording:
            self.assertGreater(len(recording["ticks/tick"]), 500)
            self.assertEqual(recording["ticks/authority"][-1], 0.0)
            self.assertFalse(recording["ticks/sent"][-1].any())
        self.expect_same_when_run_again("run.h5")

    def test_busy_port_is_said(self):
        with socket.create_server(("127.0.0.1", 0)) as taken:
            port = taken.getsockname()[1]
            result = self.run_app("run", "--wait", "--port", port, "--duration", 3, timeout=20)
            self.expect_refused(result, "port", f"127.0.0.1:{port}", "in use", lines=1)
            self.assertEqual(result.out, "")
        self.assertEqual(self.names_in(self.folder), [])

    def expect_no_socket(self, *arguments):
        run = self.start_app("run", *arguments, "--json", "run.json")
        looked = 0
        until = time.monotonic() + 20.0
        while run.poll() is None and time.monotonic() < until:
            try:
                found = inet_sockets(run.pid)
            except (FileNotFoundError, ProcessLookupError):  # it ended
                break
            self.assertEqual(found, [])
            looked += 1
            time.sleep(0.01)
        said, complained = run.communicate(timeout=20)
        self.assertEqual(run.returncode, DONE, said + complained)
        self.assertGreater(json.loads((self.folder / "run.json").read_text())["ticks"], 900)
        self.assertGreater(looked, 5)
        self.assertNotIn("http", said)

    def test_no_web_opens_no_port(self):
        self.expect_no_socket("--no-web", "--duration", 1)

    def test_simulated_clock_opens_no_port(self):
        self.expect_no_socket("--simulated-clock", "--duration", 10, "--port", 0)


class Refused(AppTest):
    def test_what_is_refused_is_named(self):
        scene = CONFIG / "scenes/table.toml"
        for arguments, texts in (
                (["--level", 99], ["level", "99", "1 .. 4"]),
                (["--level", 0], ["--level", "0"]),
                (["--level", "two"], ["--level", "two"]),
                (["--exercise", "nosuch"], ["nosuch"]),
                (["--exercise", "none/nosuch.toml"], ["none/nosuch.toml"]),
                (["--exercise", scene], ["table.toml", "kind"]),  # a file of another kind
                (["--exercise", "cocktail-bar", "--scene", scene], ["--exercise", "--scene"]),
                (["--exercise", "cocktail-bar", "--motion", "m.csv"], ["--exercise", "--motion"]),
        ):
            for how in (["--simulated-clock"], ["--port", 0, "--wait"], ["--no-web"]):
                with self.subTest(arguments=arguments, how=how):
                    result = self.run_app("run", *arguments, *how, "--duration", 1, timeout=20)
                    self.expect_refused(result, *texts)
                    self.assertLessEqual(len(result.err.splitlines()), 2, result)
        self.assertEqual(self.names_in(self.folder), [])

    def test_open_to_others_only_with_a_token(self):
        for address in ("0.0.0.0", "::", "192.0.2.1"):
            for token in ([], ["--token", ""], ["--token", "short"]):
                with self.subTest(address=address, token=token):
                    result = self.run_app("run", "--wait", "--port", 0, "--address", address, *token,
                                          "--duration", 3, timeout=20)
                    self.expect_refused(result, address, "token", "16 characters", lines=1)
                    self.assertEqual(result.out, "")  # no address was printed: nothing listened

    def test_port_that_is_none(self):
        for port in ("65536", "-1", "http"):
            with self.subTest(port):
                self.expect_refused(self.run_app("run", "--port", port, "--duration", 1, timeout=20), "--port",
                                    port)


if __name__ == "__main__":
    unittest.main(verbosity=2)
