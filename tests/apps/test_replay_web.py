"""`wholehand replay --web`: the answers about recordings over HTTP, and every kind of refused file."""
import http.client
import json
import pathlib
import signal
import struct
import urllib.parse

import numpy

from app import HANG_S, INTERRUPTED, MOTION, AppTest, main, read_recording


class ReplayWeb(AppTest):
    def serve(self, *files):
        """Starts the server and stores the address that it prints first."""
        run = self.start_app("replay", "--web", files[0], *(["--beside", files[1]] if len(files) > 1 else []),
                             "--port", 0)
        self.url = run.stdout.readline().strip()
        self.assertTrue(self.url.startswith("http://127.0.0.1:"), self.url)
        self.host = urllib.parse.urlsplit(self.url).netloc
        self.connection = http.client.HTTPConnection(self.host, timeout=HANG_S)
        self.addCleanup(self.connection.close)
        return run

    def get(self, path):
        self.connection.request("GET", path)
        answer = self.connection.getresponse()
        return answer.status, answer.read()

    def ask(self, question, name="run.h5", status=200):
        got, body = self.get(f"/api/recordings/{urllib.parse.quote(name)}/replay/{question}")
        self.assertEqual(got, status, body[:500])
        return body

    def about(self, name="run.h5"):
        return json.loads(self.ask("about", name))

    def error(self, question, name="run.h5", status=422):
        return json.loads(self.ask(question, name, status))["error"]

    def states(self, tick, count=1, step=1, name="run.h5"):
        """The state messages, after a check of their identifiers."""
        body, messages = self.ask(f"states?tick={tick}&count={count}&step={step}", name), []
        while body:
            size = struct.unpack_from("<I", body)[0]
            messages.append(body[4:4 + size])
            self.assertEqual(len(messages[-1]), size)
            self.assertEqual(messages[-1][4:8], b"WHND")
            body = body[4 + size:]
        return messages

    def series(self, from_s, to_s, columns, name="run.h5"):
        """The header, and low and high of each channel."""
        body = self.ask(f"series?from_s={from_s}&to_s={to_s}&columns={columns}", name)
        size = struct.unpack_from("<I", body)[0]
        self.assertEqual((4 + size) % 4, 0)
        header = json.loads(body[4:4 + size])
        values = numpy.frombuffer(body, "<f4", offset=4 + size).reshape(len(header["channels"]), 2, columns)
        return header, {(c["name"], c["axis"]): values[i] for i, c in enumerate(header["channels"])}


class Shown(ReplayWeb):
    def test_every_endpoint_answers_for_two_recordings(self):
        first = self.record("bar run.h5", "--exercise", "cocktail-bar", duration=4.0)
        second = self.record("run.h5", duration=1.5)
        run = self.serve(first, second)
        self.assertTrue(self.url.endswith("/replay?recording=bar%20run.h5&beside=run.h5"), self.url)

        listed = json.loads(self.get("/api/recordings")[1])["recordings"]
        self.assertEqual([r["name"] for r in listed], ["bar run.h5", "run.h5"])
        about, other = self.about("bar run.h5"), self.about()
        with read_recording(first) as f:
            ticks, sent, time_s = len(f["ticks/tick"]), f["ticks/sent"][:], f["ticks/time_s"][:]
        self.assertEqual(about["ticks"], ticks)
        self.assertAlmostEqual(about["to_s"], time_s[-1] + 1e-3)
        self.assertEqual((about["exercise"], about["level"], about["device"]), ("cocktail-bar", 1, "lambda-pride"))
        self.assertEqual((about["picture"], about["whole"], about["still_written"]), (True, True, False))
        self.assertTrue(about["result"])
        self.assertEqual((other["exercise"], other["result"]), ("", []))

        scene = self.ask("scene", "bar run.h5")
        self.assertEqual(scene[4:8], b"WHND")
        self.assertIn(b"cocktail-bar", scene)
        self.assertEqual(len(self.states(0, 256, 4, "bar run.h5")), 256)
        self.assertEqual(len(self.states(ticks - 2, 10, 1, "bar run.h5")), 2)  # fewer states at the end

        header, channels = self.series(1.0, 3.0, 50, "bar run.h5")
        rows = (time_s >= 1.0) & (time_s < 3.0)
        self.assertEqual(header["first_tick"], int(numpy.argmax(rows)))
        for axis in range(sent.shape[1]):
            low, high = channels["sent", axis]
            self.assertEqual(high.max(), numpy.float32(sent[rows, axis].max()))
            self.assertEqual(low.min(), numpy.float32(sent[rows, axis].min()))
        header, _ = self.series(0.0, 60.0, 100, "bar run.h5")
        self.assertEqual([m["kind"] for m in header["marks"]], ["armed", "stop", "neutral"])

        readers = [pid for task in pathlib.Path(f"/proc/{run.pid}/task").iterdir()
                   for pid in (task / "children").read_text().split()]
        self.assertEqual(len(readers), 3)  # states and plots of the first, description of the second
        for pid in readers:  # if memory runs out, they are killed first
            self.assertEqual(pathlib.Path(f"/proc/{pid}/oom_score_adj").read_text(), "1000\n")

        run.send_signal(signal.SIGINT)
        said, complained = run.communicate(timeout=HANG_S)
        self.assertEqual((run.returncode, complained), (INTERRUPTED, ""), said)

    def test_invalid_questions_are_refused(self):
        self.record("run.h5", duration=0.2)
        self.serve("run.h5")
        error = self.error("series?from_s=0&to_s=3600&columns=9", status=400)
        self.assertIn("to_s = 3600", error)
        self.assertIn("60 s", error)
        self.error("everything", status=404)
        for path in ("/api/recordings/other.h5/replay/about", "/api/recordings/../run.h5/replay/about",
                     "/api/recordings/..%2frun.h5/replay/about", "/api/recordings//etc/passwd/replay/about"):
            with self.subTest(path):
                self.assertIn(self.get(path)[0], (400, 404))

    def test_killed_and_unfinished_recordings_are_read_up_to_their_end(self):
        run = self.start_app("run", "--motion", MOTION, "--no-web",
                             "--duration", 600, "--record", "run.h5")

        def ticks():
            try:
                with read_recording(self.folder / "run.h5") as f:
                    return len(f["ticks/tick"])
            except (OSError, KeyError):
                return 0
        self.wait_until(run, lambda: ticks() >= 500)
        self.serve("run.h5")
        before = self.about()
        self.assertIs(before["still_written"], True)
        self.assertGreaterEqual(before["ticks"], 500)
        self.assertEqual(len(self.states(before["ticks"] - 1)), 1)
        self.wait_until(run, lambda: ticks() > before["ticks"] + 500)
        after = self.about()  # as a page that keeps reading
        self.assertGreater(after["ticks"], before["ticks"] + 300)
        self.assertEqual(len(self.states(after["ticks"] - 1)), 1)
        run.kill()
        run.wait()
        killed = self.about()
        self.assertIs(killed["still_written"], False)
        self.assertGreaterEqual(killed["ticks"], after["ticks"])


class Refused(ReplayWeb):
    def test_paths_are_checked_before_the_server_starts(self):
        (self.folder / "x.h5").mkdir()
        for path, text in (("none.h5", "does not exist"), ("x.h5", "is no regular file")):
            self.expect_refused(self.run_app("replay", "--web", path), path, text, lines=1)
        path = self.record("run.h5", duration=0.2)
        self.expect_refused(self.run_app("replay", "--web", path, "--beside", "none.h5"), "none.h5", lines=1)
        self.expect_refused(self.run_app("replay", path, "--beside", path), "--web")
        self.expect_refused(self.run_app("replay", "--web", "--resimulate", path), "--resimulate")

    def test_file_that_is_no_recording_is_the_answer_to_every_question(self):
        whole = self.record("run.h5", duration=1.0).read_bytes()
        self.serve(self.write("run.h5", whole[:len(whole) // 2]))
        for question in ("about", "scene", "states?tick=0&count=1&step=1", "series?from_s=0&to_s=1&columns=1"):
            self.assertRegex(self.error(question), "run.h5(.|\n)*truncated")


if __name__ == "__main__":
    main()
