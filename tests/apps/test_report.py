"""`wholehand replay --report`, `report` and `run --report`: one self-contained file, and its contents."""
import base64
import json
import os
import pty
import re
import resource
import shutil
import subprocess
import zlib

import h5py
import numpy

from app import (BINARY, DONE, FREE_RUN, HANG_S, NOT_WHOLE, SOURCE, AppTest, corrupt_chunk, lose_ticks, main,
                 read_recording, report_data)

MOST_BYTES = 2_000_000


def unpacked(text):
    return zlib.decompress(base64.b64decode(text))


class Series:
    """The answer "series" of src/replay/replay_question.hpp, read independently of the page's code."""

    def __init__(self, message):
        length = int.from_bytes(message[:4], "little")
        self.header = json.loads(message[4:4 + length])
        values = numpy.frombuffer(message[4 + length:], dtype="<f4")
        names = [(channel["name"], channel["axis"]) for channel in self.header["channels"]]
        self.extremes = dict(zip(names, values.reshape(len(names), 2, self.header["columns"])))


class ReportTest(AppTest):
    def report(self, recording, name="page.html", code=DONE):
        self.expect(self.run_app("replay", recording, "--report", name), code, name)
        return self.data_in(self.folder / name)

    def data_in(self, page):
        self.assertLessEqual(page.stat().st_size, MOST_BYTES)
        return report_data(page)


class OneFile(ReportTest):
    def test_page_requests_nothing_from_the_network(self):
        path = self.record(duration=0.5)
        self.report(path)
        self.assertEqual(self.names_in(self.folder), ["page.html", "run.h5"])
        page = (self.folder / "page.html").read_text()
        head = page[:page.index("<script")] + page[page.rindex("</style>"):]
        for reference in re.findall(r'(?:src|href|data|action)\s*=\s*["\']([^"\']*)', head):
            self.assertTrue(reference.startswith(("#", "data:")), reference)
        self.assertNotRegex(page, r"<(script|link|img|iframe)[^>]*(src|href)=\"(?!data:)")
        self.assertNotRegex(page, r"@import|url\(\s*['\"]?(?!#|data:|['\"]?#|\$)https?:")
        # The browser blocks any request of the page.
        policy = re.search(r'Content-Security-Policy" content="([^"]*)"', page).group(1)
        self.assertIn("default-src 'none'", policy)
        self.assertNotRegex(policy, r"connect-src|https?:|'self'|\*")

    def test_three_commands_make_the_same_page(self):
        path = self.record(duration=0.5)
        self.report(path)
        self.expect(self.run_app("report", path, "--out", "folder"), DONE, "folder/index.html")
        self.assertEqual((self.folder / "folder/index.html").read_bytes(), (self.folder / "page.html").read_bytes())

    def test_names_are_not_interpreted_as_markup(self):
        path = self.record(duration=0.3)
        for name in ("</script><script>alert(1)</script><!--", "محمد علي", "x" * 200, 'a"b\\c&lt;'):
            with self.subTest(name[:20]):
                with h5py.File(path, "r+", libver="latest") as f:
                    f["meta"].attrs["title"] = numpy.bytes_(name.encode())
                data = self.report(path)
                self.assertEqual(data["about"]["title"], name)
                self.assertNotIn("alert(1)</script>", (self.folder / "page.html").read_text())

    def test_name_of_10_kb_is_refused(self):
        path = self.record(duration=0.3)
        with h5py.File(path, "r+", libver="latest") as f:
            f["meta"].attrs["title"] = numpy.bytes_(b"x" * 10_000)
        self.expect_refused(self.run_app("replay", path, "--report", "page.html"), "run.h5", "texts that cannot be shown")
        self.assertFalse((self.folder / "page.html").exists())


class SessionBefore(ReportTest):
    def test_figures_of_the_earlier_session_are_beside_those_of_the_recording(self):
        before = self.record("before.h5", "--exercise", "cocktail-bar", "--seed", "2", duration=12)
        now = self.record("now.h5", "--exercise", "cocktail-bar", duration=2)
        own = self.report(before, "own.html")
        self.expect(self.run_app("replay", now, "--report", "page.html", "--before", before), DONE)
        data = self.data_in(self.folder / "page.html")
        self.assertEqual((data["about"]["name"], data["before"]["about"]["name"]), ("now.h5", "before.h5"))
        for part in ("about", "therapy", "engineering"):
            self.assertEqual(data["before"][part], own[part])
        events, own_events = (Series(unpacked(page["series"])).header["events"] for page in (data["before"], own))
        self.assertEqual(events, own_events)
        self.assertIn("drink_done", [own["about"]["event_names"][event["type"]] for event in events])
        self.assertEqual(data["before"]["states"]["rows"][-1], own["states"]["rows"][-1])  # for the stars
        self.expect(self.run_app("report", now, "--out", "folder", "--before", before), DONE)
        self.assertEqual((self.folder / "folder/index.html").read_bytes(), (self.folder / "page.html").read_bytes())

    def test_earlier_session_with_another_hand_device_and_exercise_is_reported(self):
        before = self.record("before.h5", "--device", str(SOURCE / "config/devices/desktop-3axis.toml"),
                             "--hand", str(SOURCE / "config/hands/woman-p05-left.toml"), duration=0.5)
        now = self.record("now.h5", "--exercise", "cocktail-bar", duration=0.5)
        self.expect(self.run_app("replay", now, "--report", "page.html", "--before", before), DONE)
        data = self.data_in(self.folder / "page.html")
        for what in ("hand", "device", "exercise"):
            self.assertNotEqual(data["about"][what], data["before"]["about"][what])
        self.assertEqual([len(page["therapy"]["limits"]) for page in (data, data["before"])], [6, 3])

    def test_invalid_earlier_recording_is_refused_and_nothing_is_written(self):
        now = self.record("now.h5", duration=0.3)
        (self.folder / "link.h5").symlink_to(now)
        self.write("text.h5", "no recording")
        for name, says in (("link.h5", "is the recording of the report itself"), ("text.h5", "text.h5"), ("none.h5", "none.h5")):
            with self.subTest(name):
                self.expect_refused(self.run_app("replay", now, "--report", "page.html", "--before", name), name, says)
                self.assertFalse((self.folder / "page.html").exists())
        self.expect_refused(self.run_app("replay", now, "--before", now), "--before")


class WhatIsInIt(ReportTest):
    def test_extremes_equal_those_of_the_recording(self):
        path = self.record("bar.h5", "--exercise", "cocktail-bar", duration=12)
        data = self.report(path)
        series = Series(unpacked(data["series"]))
        begin, end, columns = (series.header[key] for key in ("from_s", "to_s", "columns"))
        with read_recording(path) as f:
            time = f["ticks/time_s"][:]
            recorded = {name: f[f"ticks/{name}"][:] for name in ("sent", "q_m", "q_s", "phi", "damping")}
            recorded["value"] = f["ticks/exercise_values"][:]
        column = numpy.minimum(columns - 1, ((time - begin) / (end - begin) * columns).astype(int))
        compared = 0
        for (name, axis), (low, high) in series.extremes.items():
            if name not in recorded:
                continue
            compared += 1
            own = recorded[name][:, axis].astype(numpy.float32)
            for at in range(columns):
                there = own[column == at]
                self.assertEqual((low[at], high[at]), (there.min(), there.max()), (name, axis, at))
        self.assertEqual(compared, 5 * 6 + len(data["about"]["value_names"]))
        # The figures of the exercise, as in the summary.
        self.assertEqual([line["name"] for line in data["about"]["result"]], ["poured_total_l", "spilt_l", "score"])
        self.assertIn("drink_done", [data["about"]["event_names"][e["type"]] for e in series.header["events"]])
        self.assertEqual(data["states"]["rows"][-1], len(time) - 1)
        self.assertEqual(data["therapy"]["limits"][0], [[0.0, 20.0]])  # config/devices/lambda-pride.toml

    def test_damage_is_reported_and_the_rest_is_shown(self):
        path = self.record(duration=2.0)
        first = corrupt_chunk(path, "ticks/rendered", 1)
        (hole,) = Series(unpacked(self.report(path, code=NOT_WHOLE)["series"])).header["unreadable"]
        self.assertAlmostEqual(hole["from_s"], first * 1e-3, delta=2e-3)

    def test_missing_ticks_are_reported(self):
        path = self.record(duration=2.0)
        lose_ticks(path, 500, 1200)
        data = self.report(path, code=NOT_WHOLE)
        self.assertEqual(data["about"]["ticks_missing"], 700)
        (gap,) = Series(unpacked(data["series"])).header["gaps"]
        self.assertEqual(gap["ticks"], 700)

    def test_recording_without_its_files_has_all_but_the_picture(self):
        path = self.record(duration=0.5)
        with h5py.File(path, "r+", libver="latest") as f:
            for group in f["meta/files"].values():
                if b"scenes/" in group.attrs["name"]:
                    group.attrs["name"] = numpy.bytes_("scene.txt")
        data = self.report(path)
        self.assertNotIn("states", data)
        self.assertIn("carries no scene file", data["about"]["no_picture_because"])
        self.assertGreater(len(Series(unpacked(data["series"])).extremes), 20)


class HowItGoes(ReportTest):
    def test_a_minute_costs_less_than_two_seconds_of_processor_slow(self):
        path = self.record("bar.h5", "--exercise", "cocktail-bar", duration=60)
        before = resource.getrusage(resource.RUSAGE_CHILDREN)
        self.report(path)
        after = resource.getrusage(resource.RUSAGE_CHILDREN)
        used_s = after.ru_utime + after.ru_stime - before.ru_utime - before.ru_stime
        print(f"figure: report of a minute of the bar: {used_s:.2f} s of CPU, "
              f"{(self.folder / 'page.html').stat().st_size / 1e6:.2f} MB")
        self.assertLess(used_s, 2.0)

    def test_progress_is_shown_on_a_terminal(self):
        path = self.record(duration=12)
        terminal, other_end = pty.openpty()
        run = subprocess.run([str(BINARY), "replay", str(path), "--report", "page.html"], cwd=self.folder,
                             stdin=subprocess.DEVNULL, stdout=subprocess.DEVNULL, stderr=other_end, timeout=HANG_S)
        os.close(other_end)
        self.assertEqual(run.returncode, DONE)
        self.assertIn(b"Reading the recording: ", os.read(terminal, 10_000))
        os.close(terminal)

    def test_missing_pages_are_reported_with_how_to_build_them(self):
        path = self.record(duration=0.3)
        tree = self.folder / "tree/bin"
        tree.mkdir(parents=True)
        binary = tree / "wholehand"
        shutil.copy(BINARY, binary)
        for name in ("config", "data"):
            (self.folder / "tree" / name).symlink_to(SOURCE / name)
        self.expect_refused(self.run_app("replay", path, "--report", "page.html", binary=binary),
                            "web/dist/report.html", "npm run build", lines=1)
        self.assertFalse((self.folder / "page.html").exists())
        # A report requested by name is refused before the device is armed; otherwise the run is recorded without one.
        self.expect_refused(self.run_app(*FREE_RUN, "--simulated-clock", "--report", "r", binary=binary),
                            "npm run build", lines=1)
        self.expect(self.run_app(*FREE_RUN, "--simulated-clock", "--duration", "0.2", binary=binary), DONE,
                    "No report: ", "npm run build")
        (run,) = (self.folder / "out").iterdir()
        self.assertEqual(self.names_in(run), ["recording.h5", "run.json"])


if __name__ == "__main__":
    main()
