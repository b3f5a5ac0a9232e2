"""Several sessions in one run, their recordings and file names, and recordings for which the disk had no room."""
import calendar
import fcntl
import json
import re
import signal
import socket
import time
import urllib.request

import client
from app import FULL, HANG_S, INTERRUPTED, PacedTest, limit_file_size, main, read_recording

TICK, RUN_STATE = 1, 4  # fields of WorldState
RENDERING = 1           # RunState


class Running(PacedTest):
    def start(self, *more, **how):
        run = self.start_app("run", "--port", 0, "--wait", "--no-rehearsal", *more, **how)
        self.url = run.stdout.readline().strip()
        self.page = client.Page(int(self.url.split(":")[2].rstrip("/")))
        self.page.hold_controls()
        self.endings = 1  # before the first session the count is 1
        return run

    def session(self, run, seconds, until=lambda: True):
        """Runs a session until the loop has rendered for so many seconds of ticks and `until` is true."""
        accepted, reason = self.page.arm(self.endings)
        self.assertTrue(accepted, reason)
        self.wait_until(run, lambda: self.page.state is not None and self.page.state.number(RUN_STATE, "b") == RENDERING
                        and self.page.state.number(TICK, "Q") >= 1000 * seconds)
        self.wait_until(run, until)
        self.assertTrue(self.page.answer(self.page.say(client.EMERGENCY_STOP))[0])
        self.endings += 2  # the stop and the end of the session are endings
        self.page.wait_for_endings(self.endings)

    def listed(self):
        with urllib.request.urlopen(self.url + "api/recordings", timeout=HANG_S) as answer:
            return json.load(answer)["recordings"]

    def end(self, run):
        self.page.socket.close()
        run.send_signal(signal.SIGINT)
        out, err = run.communicate(timeout=HANG_S)
        self.assertEqual(run.returncode, INTERRUPTED, out + err)
        return out

    def dropped(self):
        metrics = urllib.request.urlopen(self.url + "metrics", timeout=HANG_S).read().decode()
        return int(re.search(r"dropped_records_total (\d+)", metrics)[1])


class Sessions(Running):
    def test_files_of_each_session_share_its_number(self):
        run = self.start("--record", "run.h5", "--json", "run.json", "--report", "report")
        listed = []
        self.session(run, 1.0, until=lambda: listed.extend(self.listed()) or True)
        self.assertEqual([(entry["name"], entry["being_written"]) for entry in listed], [("run.h5", True)])
        self.assertEqual(self.listed(), [])  # the recording is at the requested path
        ticks = self.page.state.number(TICK, "Q")
        self.session(run, 1.0 + 1e-3 * ticks)
        said = self.end(run)
        self.assertEqual([n for n in self.names_in(self.folder) if not n.startswith(("report", "out"))],
                         ["run-2.h5", "run-2.json", "run-2.wbb", "run.h5", "run.json", "run.wbb"])  # .wbb: black box
        ticks = []
        for number in ("", "-2"):
            summary = json.loads((self.folder / f"run{number}.json").read_text())
            with read_recording(self.folder / f"run{number}.h5") as recording:
                self.assertEqual(recording["ticks/tick"][-1] + 1, summary["ticks"])
            self.assertIn("<html", (self.folder / f"report{number}/index.html").read_text())
            ticks.append(summary["ticks"])
        self.assertGreater(ticks[1], ticks[0])
        for text in ("session 1: ", "session 2: ", "recorded run.h5", "recorded run-2.h5", "report   report-2/"):
            self.assertIn(text, said)
        lines = re.findall(r"^ +([\d.]+) s .* tick \d+/\d+/\d+ µs", said, re.MULTILINE)
        self.assertEqual([float(s) < 1.0 for s in lines], [True, True], said)  # soon after each start

    def test_unread_output_delays_no_session(self):
        """The output is a stopped terminal (Ctrl-S) or a pipe whose reader hangs."""
        run = self.start("--record", "run.h5")
        lines, pipe_bytes = 40, 4096
        fcntl.fcntl(run.stdout, fcntl.F_SETPIPE_SZ, pipe_bytes)
        filler = "p" + "x" * 59  # 60 characters, the longest profile name
        for _ in range(pipe_bytes // 60 + lines):
            self.assertTrue(self.page.answer(self.page.say(client.SAVE_PROFILE, filler))[0])
        for _ in range(2):
            self.session(run, 0.5)
        for name in ("run.h5", "run-2.h5"):
            with read_recording(self.folder / name) as recording:
                self.assertGreater(recording.rows(), 500)
        self.page.socket.close()
        run.send_signal(signal.SIGINT)
        time.sleep(0.5)
        said, complained = run.communicate(timeout=HANG_S)  # reads the rest
        self.assertEqual(run.returncode, INTERRUPTED, said + complained)

    def test_run_that_is_never_armed_leaves_no_files_and_reports_it(self):
        run = self.start("--record", "run.h5", "--report", "report")
        said = self.end(run)
        self.assertEqual(self.names_in(self.folder), [])
        self.assertNotIn("recorded", said)

    def test_recording_on_a_full_disk_is_reported_during_the_run_and_in_the_list(self):
        run = self.start(preexec_fn=limit_file_size(4_500_000))
        began = int(time.time())
        self.session(run, 4.0, lambda: self.dropped() > 100)
        ended = time.time()
        entry, = self.listed()
        metrics = urllib.request.urlopen(self.url + "metrics", timeout=HANG_S).read().decode()
        said = self.end(run)
        recording = self.folder / "out/recordings" / entry["name"]
        with read_recording(recording) as f:
            kept = len(f["ticks/tick"])
        self.assertGreater(kept, 100)
        self.assertGreater(entry["ticks_missing"], 100)
        self.assertIn("the disk accepts no more data", said)
        self.assertIn(f"the recording holds {kept} of {kept + entry['ticks_missing']} ticks", said)
        self.assertRegex(metrics, r"dropped_records_total [1-9]")
        made = calendar.timegm(time.strptime(entry["created_utc"], "%Y-%m-%dT%H:%M:%SZ"))
        self.assertTrue(began <= made < ended - 3.5, "when it began, not when it ended")


class Unasked(PacedTest):
    """Sessions that `run` arms by itself, as with ./start."""

    def start(self, *more, **how):
        run = self.start_app("run", "--port", 0, "--no-rehearsal", *more, **how)
        self.url = run.stdout.readline().strip()
        self.page = client.Page(int(self.url.split(":")[2].rstrip("/")))
        self.wait_until(run, lambda: self.page.state is not None and self.page.scene is not None
                        and self.page.state.number(TICK, "Q") >= 300)
        return run

    def recordings(self):
        return sorted(name for name in self.names_in(self.folder) if name.endswith(".h5"))

    def test_session_that_somebody_joins_is_kept_from_its_first_tick(self):
        run = self.start()
        self.page.hold_controls()
        self.assertTrue(self.page.answer(self.page.say(client.STEER, ("b", client.PERSON)))[0])
        ticks = self.page.state.number(TICK, "Q")
        self.wait_until(run, lambda: self.page.state.number(TICK, "Q") >= ticks + 300)
        said = self.expect_ended_by(run, signal.SIGINT)
        name, = self.recordings()
        self.assertRegex(name, r"^out/recordings/\d{8}-\d{6}-cocktail-bar-level-1\.h5$")
        with read_recording(self.folder / name) as recording:
            self.assertEqual(recording["ticks/tick"][0], 0)
            self.assertGreaterEqual(recording["ticks/tick"][-1], ticks + 300)
        self.assertIn("recorded " + name, said)

    def test_session_that_nobody_joins_is_recorded_but_not_kept(self):
        run = self.start()
        self.assertEqual(len(self.recordings()), 1)
        said = self.expect_ended_by(run, signal.SIGINT)
        self.assertEqual(self.recordings(), [])
        self.assertNotIn("recorded out/", said)

    def test_run_without_a_possible_recording_continues_and_reports_it(self):
        (self.folder / "out").write_text("a file where a folder should be")
        run = self.start()
        line = next((line for line in run.stdout if "what follows is not recorded" in line), "")
        self.assertIn("out/recordings: takes no new recording", line)
        self.expect_ended_by(run, signal.SIGINT)

    def test_eight_programs_started_at_once_use_different_names(self):
        runs = [self.start_app("run", "--port", 0, "--no-rehearsal") for _ in range(8)]
        pages = [client.Page(int(run.stdout.readline().strip().split(":")[2].rstrip("/"))) for run in runs]
        for run, page in zip(runs, pages):
            self.wait_until(run, lambda page=page: page.state is not None and page.state.number(TICK, "Q") >= 100)
            page.hold_controls()
        for run in runs:
            run.send_signal(signal.SIGINT)
        said = [run.communicate(timeout=HANG_S)[0] for run in runs]
        self.assertEqual(len(self.recordings()), 8, said)
        for name in self.recordings():
            with read_recording(self.folder / name) as recording:
                self.assertEqual(recording["ticks/tick"][0], 0)


class Crowd(Running):
    def half_open(self, port):
        line = socket.create_connection(("127.0.0.1", port), timeout=HANG_S)
        line.sendall(b"GET / HT")
        return line

    def mute(self, port):
        """A WebSocket client that reads nothing."""
        line = socket.create_connection(("127.0.0.1", port), timeout=HANG_S)
        line.sendall(f"GET /ws HTTP/1.1\r\nHost: 127.0.0.1:{port}\r\nUpgrade: websocket\r\nConnection: Upgrade\r\n"
                     "Sec-WebSocket-Version: 13\r\nSec-WebSocket-Key: dGhlIHNhbXBsZSBub25jZQ==\r\n\r\n".encode())
        return line

    def test_clients_that_never_read_do_not_block_others(self):
        run = self.start()
        port = int(self.url.split(":")[2].rstrip("/"))
        crowd, took = [], {"health": [], "newcomer": [], "stop": []}

        def timed(what, action):
            began = time.monotonic()
            result = action()
            took[what].append(time.monotonic() - began)
            return result
        for i in range(1000 if FULL else 300):
            crowd.append((self.mute if i % 2 else self.half_open)(port))
            if i % (5 if FULL else 20):  # 200 samples of each kind give a 99th percentile
                continue
            timed("health", lambda: urllib.request.urlopen(self.url + "healthz", timeout=HANG_S).read())
            page = timed("newcomer", lambda: client.Page(port))
            accepted, reason = timed("stop", lambda: page.answer(page.say(client.EMERGENCY_STOP)))
            self.assertTrue(accepted, reason)
            page.socket.close()
        for what, limit_s in (("health", 0.1), ("newcomer", 0.2), ("stop", 0.05)):
            times = sorted(took[what])
            p99 = times[max(0, -(-99 * len(times) // 100) - 1)]  # nearest rank
            print(f"figure: {what} beside a crowd of {len(crowd)}, {len(times)} times, "
                  f"median = {1e3 * times[len(times) // 2]:.1f} ms, p99 = {1e3 * p99:.1f} ms, "
                  f"largest = {1e3 * times[-1]:.1f} ms")
            self.assertLess(times[len(times) // 2], limit_s)  # one sample may coincide with a stall of the machine
        for line in crowd:
            line.close()
        self.end(run)


if __name__ == "__main__":
    main()
