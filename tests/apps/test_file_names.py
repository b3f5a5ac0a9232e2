"""Every command that prints a path, with untrusted file names: they are always escaped on a terminal."""
import os
import pathlib
import re
import shutil
import signal
import subprocess

import h5py
import numpy

from app import BAD_INPUT, BINARY, CONFIG, DIFFERENT, DONE, FREE_RUN, HANG_S, INTERRUPTED, MOTION, AppTest, main
from test_sweep import GRID

DRIVERS = pathlib.Path(os.environ.get("WHOLEHAND_DRIVERS", BINARY.parent / "drivers")).resolve()

# A name that clears the screen by C0 and C1 codes, reverses the reading direction, rings the bell, deletes, starts a
# new line, and is not UTF-8.
HOSTILE = b"e\x1b[2J\xc2\x9b2J\xe2\x80\xae\x07\x7f\nFORGED\xe2\x80\xa8\xff"
SHOWN = r"e\x1b[2J\u{009b}2J\u{202e}\x07\x7f\x0aFORGED\u{2028}\xff"  # the escaped name, by loop/core/printable.hpp
LONG = b"L" * 230

STEERS = re.compile("[\0-\x08\x0b-\x1f\x7f-\x9f\u061c\u200e\u200f\u2028-\u202e\u2066-\u2069]")
INVALID = re.compile("[\ud800-\udfff]")  # Python's code points for bytes that are not UTF-8
CUT = 200

SCENE = """kind = "scene"
version = 1
name = "t"
gravity_m_s2 = [0.0, 0.0, 0.0]
[[bodies]]
name = "b"
shape = "{shape}"
file = "{file}"
mass_kg = 0.1
position_m = [0.6, 0.0, 0.5]
"""
TETRAHEDRON = "v 0 0 0\nv 0.03 0 0\nv 0 0.03 0\nv 0 0 0.03\nf 1 3 2\nf 1 2 4\nf 1 4 3\nf 2 3 4\n"
# An open mesh: it is replaced by its hull, and a notice says so.
OPEN = TETRAHEDRON.replace("f 2 3 4\n", "")


def in_toml(name):
    """A file's name as a TOML string, which must be UTF-8."""
    return "".join(f"\\u{ord(c):04x}" if ord(c) < 0x20 or ord(c) >= 0x7F else c for c in name.decode())


def words(*arguments):
    return [a if isinstance(a, bytes) else os.fsencode(str(a)) for a in arguments]


class FileNames(AppTest):
    def named(self, ending, text=None, name=HOSTILE):
        """Path of a file of this name, as bytes; written if there is a text."""
        path = os.path.join(os.fsencode(self.folder), name + ending.encode())
        if text is not None:
            with open(path, "wb") as out:
                out.write(text if isinstance(text, bytes) else text.encode())
        return path

    def copied(self, source, ending, name=HOSTILE):
        return self.named(ending, pathlib.Path(source).read_bytes(), name)

    def said(self, *arguments, cwd=None, timeout=HANG_S):
        """Runs a command, checks that its output is text, and returns it."""
        done = subprocess.run(words(BINARY, *arguments), cwd=cwd or self.folder, timeout=timeout, stdin=subprocess.DEVNULL,
                              capture_output=True)
        return done.returncode, self.expect_text(done.stdout + done.stderr, done.returncode)

    def said_until_interrupted(self, *arguments):
        """Runs a command with pages, interrupts it by Ctrl-C after its first line, and returns its output."""
        run = subprocess.Popen(words(BINARY, *arguments), cwd=self.folder, stdin=subprocess.DEVNULL, stdout=subprocess.PIPE,
                               stderr=subprocess.PIPE)
        self.addCleanup(run.communicate)
        self.addCleanup(run.kill)
        first = run.stdout.readline()
        run.send_signal(signal.SIGINT)
        out, errors = run.communicate(timeout=HANG_S)
        return self.expect_text(first + out + errors, run.returncode)

    def expect_text(self, output, code):
        said = output.decode(errors="surrogateescape")
        self.assertIn(code, (DONE, DIFFERENT, BAD_INPUT, INTERRUPTED), said)  # the program did not crash
        self.assertIsNone(INVALID.search(said), repr(said))
        self.assertIsNone(STEERS.search(said), repr(said))
        self.assertNotRegex(said, r"(?m)^\W*FORGED", "a name began a line")
        self.assertLess(max(map(len, re.findall("L+", said)), default=0), CUT + 1, f"not cut: {said}")
        return said

    def expect_shown(self, code, *arguments, times=1, **how):
        ended, said = self.said(*arguments, **how)
        self.assertEqual(ended, code, said)
        self.assertGreaterEqual(said.count(SHOWN), times, said)
        return said

    def expect_refused_of_both(self, *arguments, ending):
        """A missing file is named with its name escaped, and a long name is cut."""
        self.expect_shown(BAD_INPUT, *arguments, self.named(ending))
        ended, said = self.said(*arguments, self.named(ending, name=LONG))
        self.assertEqual(ended, BAD_INPUT, said)
        self.assertIn("...", said)

    def test_missing_files_are_named_escaped(self):
        for command, ending in (
                (["run", "--simulated-clock", "--scene"], ".toml"), (["run", "--simulated-clock", "--hand"], ".toml"),
                (["run", "--simulated-clock", "--device"], ".toml"), (["run", "--simulated-clock", "--rendering"], ".toml"),
                (["run", "--simulated-clock", "--patient"], ".toml"), (["run", "--simulated-clock", "--motion"], ".csv"),
                (["run", "--simulated-clock", "--exercise"], ".toml"), (["run", "--certificate"], ".json"),
                (["run", "--simulated-clock", "--driver"], ".so"),
                (["replay"], ".h5"), (["replay", "--resimulate"], ".h5"), (["replay", "--web", "--port", 0], ".h5"),
                (["report", "--out", "out"], ".h5"), (["validate"], ".toml"), (["validate"], ".csv"),
                (["validate", "--admit"], ".toml"), (["certify", "--device"], ".toml"), (["certify", "--rendering"], ".toml"),
                (["certify", "--hand"], ".toml"), (["certify", "--exercise"], ".toml"), (["certify", "--passport"], ".toml"),
                (["certify", "--impedance", "--device"], ".toml"), (["decompose", "--out", "out"], ".obj"),
                (["sweep", "--out", "out.h5"], ".toml"),
                (["device", "inspect", "--driver"], ".so"), (["device", "conform", "--driver"], ".so"),
                (["device", "commission", "--operator", "A", "--driver", DRIVERS / "frame.so", "--device"], ".toml"),
                (["device-host", "--name", "n", "--driver", DRIVERS / "frame.so", "--device"], ".toml")):
            with self.subTest(" ".join(map(str, command))):
                self.expect_refused_of_both(*command, ending=ending)

    def test_files_of_a_run_are_printed_escaped(self):
        scene = self.copied(CONFIG / "scenes/four-shapes.toml", ".toml")
        recording, report, summary = self.named(".h5"), self.named(".report"), self.named(".json")
        said = self.expect_shown(DONE, *FREE_RUN, "--simulated-clock", "--duration", 0.2, "--scene", scene,
                                 "--record", recording, "--report", report, "--json", summary, times=2)
        self.assertIn("recorded", said)
        self.said("replay", recording)  # replay prints the title
        for command in (["replay", "--resimulate", recording],
                        ["replay", "--report", self.named(".html"), recording], ["report", recording, "--out", report]):
            with self.subTest(" ".join(map(str, command[:2]))):
                self.expect_shown(DONE, *command)
        self.expect_shown(BAD_INPUT, "replay", "--extract", self.named(".2.h5"), recording)
        pages = self.said_until_interrupted("replay", "--web", "--port", 0, recording)
        self.assertIn("/replay?recording=e%1B%5B2J", pages)
        opening = self.said_until_interrupted("run", "--port", 0, "--exercise", "free-grasping", "--record", self.named(".3.h5"))
        self.assertIn("http://", opening)
        for what in ("--record", "--report", "--json"):
            with self.subTest(f"{what}, long"):
                self.said(*FREE_RUN, "--simulated-clock", "--duration", 0.1, what, self.named("", name=LONG))

    def test_unreadable_recordings_are_named_escaped(self):
        damaged = self.named(".h5", b"\x89HDF\r\n\x1a\n" + bytes(100))
        box = self.named(".wbb", b"no box")
        for command in (["replay", damaged], ["replay", "--resimulate", damaged], ["report", damaged, "--out", "out"],
                        ["replay", box], ["report", box, "--out", "out"]):
            with self.subTest(" ".join(map(str, command))):
                self.expect_shown(BAD_INPUT, *command)

    def test_title_of_a_recording_is_printed_escaped(self):
        recording = self.record(duration=0.2)
        with h5py.File(recording, "r+", libver="latest") as f:
            del f["meta"].attrs["title"]
            f["meta"].attrs["title"] = numpy.bytes_(HOSTILE)
        for command in (["replay"], ["replay", "--resimulate"], ["report", "--out", "out"]):
            code, said = self.said(*command, recording)
            self.assertEqual(code, BAD_INPUT, said)
            self.assertIn("texts that cannot be shown", said)

    def test_validated_files_are_named_escaped(self):
        for kind in ("devices/lambda-pride", "hands/adult-median-right", "scenes/four-shapes", "rendering/lambda-pride",
                     "patients/relaxed-adult", "exercises/cocktail-bar", "sweeps/grasp-map"):
            with self.subTest(kind):
                path = self.copied(CONFIG / f"{kind}.toml", ".toml")
                self.said("validate", path)  # an exercise names other files, relative to its folder
                self.named(".toml", (CONFIG / f"{kind}.toml").read_bytes() + b"\nbogus = 1\n")
                self.expect_shown(BAD_INPUT, "validate", path)
        self.expect_shown(DONE, "validate", self.copied(MOTION, ".csv"))
        self.expect_shown(BAD_INPUT, "validate", self.named(".csv", "time,bogus\n"))

    def test_meshes_and_urdfs_of_a_scene_are_named_escaped(self):
        # TOML is UTF-8, and the scene reader refuses characters that cannot be shown.
        refused = self.write("scene.toml", SCENE.format(shape="mesh", file=in_toml(HOSTILE[:-1]) + ".obj"))
        self.assertIn("control characters", self.said("validate", refused)[1])
        urdf = '<robot name="r"><link name="a"><collision><geometry><mesh filename="{}"/></geometry></collision></link></robot>'
        for ending, text, code in (("obj", OPEN, DONE), ("stl", "solid t\n", BAD_INPUT), ("dae", None, BAD_INPUT),
                                   ("bogus", "x", BAD_INPUT)):
            with self.subTest(ending):
                # The files are in a folder with such a name, which begins every path in a message.
                folder = pathlib.Path(os.fsdecode(self.named("." + ending)))
                folder.mkdir()
                if text is not None:
                    (folder / f"mesh.{ending}").write_text(text)
                (folder / "scene.toml").write_text(SCENE.format(shape="mesh", file=f"mesh.{ending}"))
                self.expect_shown(code, "validate", folder / "scene.toml")
                (folder / "r.urdf").write_text(urdf.format(f"mesh.{ending}"))
                (folder / "scene.toml").write_text(SCENE.format(shape="urdf", file="r.urdf"))
                self.expect_shown(code, "validate", folder / "scene.toml")
                (folder / "r.urdf").write_text(urdf.format(f"&#x9b;2J&#10;FORGED&#x202e;.{ending}"))
                self.expect_shown(BAD_INPUT, "validate", folder / "scene.toml")
        (folder / "scene.toml").write_text(SCENE.format(shape="urdf", file="none.urdf"))
        self.expect_shown(BAD_INPUT, "validate", folder / "scene.toml", times=2)
        for shape, ending in (("mesh", "obj"), ("urdf", "urdf")):
            long = self.write("scene.toml", SCENE.format(shape=shape, file=LONG.decode()[:190] + "/" + "x" * 5 + "." + ending))
            self.assertIn("...", self.said("validate", long)[1])

    def test_files_of_decompose_are_printed_escaped(self):
        mesh = self.named(".obj", TETRAHEDRON)
        self.expect_shown(DONE, "decompose", mesh, "--out", self.named(".pieces"), "--json", self.named(".json"), times=2)
        self.expect_shown(BAD_INPUT, "decompose", self.named(".stl", "solid t\n"), "--out", "out")
        self.said("decompose", self.named(".obj", TETRAHEDRON, LONG), "--out", self.named("", name=LONG))
        self.expect_shown(BAD_INPUT, "decompose", mesh, "--out", mesh)

    def test_files_of_certify_are_printed_escaped(self):
        device = self.copied(CONFIG / "devices/lambda-pride.toml", ".toml")
        rendering = self.copied(CONFIG / "rendering/lambda-pride.toml", ".gains.toml")
        self.said("certify", "--device", device, "--rendering", rendering, "--json", self.named(".json"),
                          "--charts", self.named(".html"))
        self.expect_shown(BAD_INPUT, "certify", "--passport", self.named(".passport", "kind = 1"))
        self.expect_shown(BAD_INPUT, "run", "--certificate", self.named(".no.json", "{"))

    def test_files_of_sweeps_are_printed_escaped(self):
        grid = self.named(".grid", GRID)
        self.expect_shown(DONE, "sweep", grid, "--out", self.named(".h5"), "--chart", self.named(".html"), "--processes", 1)
        self.expect_shown(DONE, "sweep", grid, "--out", self.named(".shares"), "--share", "1/2")
        # The name that the grid itself states.
        name = HOSTILE[:-1]
        self.copied(CONFIG / "patients/stiff-adult.toml", ".toml", name)
        named = self.named(".named", GRID.replace("stiff-adult", in_toml(name) + ".toml"))
        self.said("sweep", named, "--out", "named.h5", "--processes", 1)
        missing = self.named(".none", GRID.replace("stiff-adult", in_toml(name) + ".none.toml"))
        ended, said = self.said("sweep", missing, "--out", "out.h5", "--processes", 1)
        self.assertEqual(ended, BAD_INPUT, said)

    def test_results_of_experiments_are_printed_escaped(self):
        out = self.named(".out")
        self.expect_shown(DONE, "experiment", "timing", "--ticks", 2000, "--simulated-clock", "--out", out, times=3)
        self.expect_shown(DONE, "experiment", "grasping", "--only", "pinch sphere", "--out", out, times=3)
        self.expect_shown(DONE, "experiment", "exercise", "--out", out, times=3)
        self.expect_shown(DONE, "experiment", "cocktail-bar", "--level", 1, "--seeds", 1, "--json", self.named(".json"))

    def test_names_of_drivers_are_printed_escaped(self):
        text = (CONFIG / "devices/desktop-3axis.toml").read_bytes()
        device = self.named(".toml", text)
        fake = self.named(".so", "no shared object")
        self.said("device", "conform", "--driver", fake)  # prints names of checks, not of files
        for command in (["device", "inspect", "--driver", fake],
                        ["run", "--exercise", "free-grasping", "--driver", fake, "--without-passport", "--device", device],
                        ["device", "commission", "--operator", "A", "--driver", fake, "--device", device],
                        ["device-host", "--name", "n", "--driver", fake, "--device", device]):
            with self.subTest(" ".join(map(str, command[:2]))):
                self.expect_shown(BAD_INPUT, *command)
        self.expect_shown(BAD_INPUT, "device", "inspect", "--driver", DRIVERS / "frame.so", "--device-at", HOSTILE)
        self.said("device", "inspect", "--driver", DRIVERS / "frame.so", "--driver-settings", HOSTILE)

    def test_drivers_beside_the_program_are_listed_escaped(self):
        programs = pathlib.Path(os.fsdecode(self.named(".bin")))
        (programs / "drivers").mkdir(parents=True)
        shutil.copy(BINARY, programs / "wholehand")
        with open(os.path.join(os.fsencode(programs / "drivers"), HOSTILE + b".so"), "wb") as driver:
            driver.write(b"no shared object")
        done = subprocess.run([programs / "wholehand", "device", "list"], capture_output=True, timeout=HANG_S, cwd=self.folder)
        self.assertIn(SHOWN, self.expect_text(done.stdout + done.stderr, done.returncode))

    def test_working_folder_with_such_a_name_is_printed_escaped(self):
        folder = self.named(".folder")
        os.mkdir(folder)
        for command in (["doctor"], ["validate", "none.toml"], [*FREE_RUN, "--simulated-clock", "--duration", 0.1],
                        ["device", "list"], ["certify"]):
            with self.subTest(command[0]):
                self.said(*command, cwd=folder)


if __name__ == "__main__":
    main()
