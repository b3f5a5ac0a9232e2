"""The code pieces of README.md and docs/*.md: each is run unchanged, or listed below with what runs it or why nothing
does."""
import functools
import os
import pathlib
import re
import shlex
import shutil
import signal
import socket
import subprocess
import sys
import textwrap

import h5py

import client
from app import ALWAYS, BINARY, CONFIG, DONE, FREE_RUN, HANG_S, INTERRUPTED, SOURCE, AppTest, main
from device_app import DRIVERS, DeviceTest

sys.path.append(str(SOURCE / "tests/golden"))
import datagrams  # noqa: E402
from test_decompose import CUP, obj  # noqa: E402

BUILT = BINARY.parent
DOCS = SOURCE / "docs"
PAGES = ["../README.md", *(path.name for path in sorted(DOCS.glob("*.md")))]
FENCED = re.compile(r"^( *)```(\w*)\n(.*?)^\1```$", re.S | re.M)

# The pieces of each page in their order: the test of this file or another file that runs it, or why nothing does.
PIECES = {
    "../README.md": ["test_both_commands_run", "test_idea_of_the_readme_is_the_example"],
    "architecture.md": ["not run: the table of a tick", "not run: a drawing"],
    "certificate.md": ["test_every_option_exists"],
    "clinic.md": 5 * ["tests/apps/test_clinic.py"],
    "commissioning.md": 3 * ["test_commissioning_starts_with_the_documented_commands"],
    "composite.md": ["test_composite_file_is_read"],
    "device-host.md": ["test_loop_moves_the_device_of_a_host", "test_gains_of_a_host_match_the_page"],
    "drivers.md": ["test_first_commands_lead_to_a_rendering_device", "tests/apps/test_packages.py",
                   "test_conformance_commands_run"],
    "embedding.md": ["tests/examples/embed.sh", "test_embedding_lines_are_those_of_the_tested_project"],
    "exercises.md": ["test_exercises_are_run", "tests/exercises/third/CMakeLists.txt",
                     "not run: builds the program again; tests/exercises/third compiles, loads and plays the exercise"],
    "force-dimension.md": ["test_vendor_devices_are_found_by_their_commands"],
    "frame.md": ["test_frame_commands_run_without_hardware", "test_c_code_of_the_frame_compiles"],
    "impedance.md": ["test_every_option_exists"],
    "moteus.md": ["test_vendor_devices_are_found_by_their_commands"],
    "packages.md": ["packaging/try_in_bare_debian.sh"],
    "patients.md": ["test_links_of_a_patient_are_read"],
    "program.md": ["test_own_files_can_be_used", "test_mesh_with_a_hollow_is_decomposed"],
    "protocol.md": ["tests/golden/test_run.py"],
    "recording.md": ["tests/record/recording_test.cpp", "test_data_that_matlab_reads_exists",
                     "test_octave_lines_run_slow", "test_black_box_commands_run"],
    "sweeps.md": ["test_shipped_sweep_is_drawn_slow", "test_sweep_grid_runs", "tests/apps/test_sweep.py"],
    "udp.md": ["test_example_datagram_matches_the_text"],
}


def pieces(page):
    """(language, text) of each fenced piece of a page."""
    return [(language, textwrap.dedent(text)) for _, language, text in FENCED.findall((DOCS / page).read_text())]


def commands(page, piece=0):
    """The words of each command of a piece."""
    text = pieces(page)[piece][1].replace("\\\n", " ")
    return [words for line in text.splitlines() if (words := shlex.split(line, comments=True))]


@functools.cache
def help_of(program, *subcommand):
    return subprocess.run([BUILT / program, *subcommand, "--help"], text=True, capture_output=True, check=True).stdout


class Pages(AppTest):
    def test_every_piece_is_listed(self):
        mine = {name for case in (Pages, Files, Devices) for name in dir(case)}
        for page in PAGES:
            text = (DOCS / page).read_text()
            self.assertEqual(len(pieces(page)), len(PIECES.get(page, ())), f"pieces of {page}; name new ones in PIECES")
            self.assertEqual(text.count("```"), 2 * len(pieces(page)), f"{page}: a fence that is not read")
            self.assertNotRegex(FENCED.sub("", text), r"(?m)^    (\./|wholehand|cmake|ninja|apt)", f"{page}: a command without fence")
        self.assertLessEqual(set(PIECES), set(PAGES))
        for by in (by for runs in PIECES.values() for by in runs):
            self.assertTrue(by in mine or (SOURCE / by).is_file() or by.startswith("not run: "), by)

    def test_both_commands_run(self):
        for script, mentions in zip(commands("../README.md"), ("--lab", "--full")):
            said = subprocess.run([SOURCE / script[0], "--help"], text=True, capture_output=True, check=True).stdout
            self.assertIn(mentions, said)

    def test_idea_of_the_readme_is_the_example(self):
        """Every call of README's twelve lines stands in the example that they point to, which is built and run."""
        example = (SOURCE / "examples/08_rig_alone.cpp").read_text()
        calls = set(re.findall(r"\b([a-z]\w*)\(", re.sub(r"//.*", "", pieces("../README.md")[1][1]))) - {"while", "move"}
        self.assertGreater(len(calls), 7)
        self.assertEqual({name for name in calls if f"{name}(" not in example}, set())

    def options_of(self, program, words):
        """The options in the --help of the longest subcommand that the words contain."""
        path = []
        while words and re.search(rf"(?m)^  {re.escape(words[0])} ", help_of(program, *path).partition("Subcommands:")[2]):
            path.append(words.pop(0))
        self.assertTrue(path or not re.match("[a-z]", " ".join(words)), f"{program} has no such subcommand: {words}")
        return set(re.findall(r"--[a-z][a-z-]*", help_of(program, *path)))

    def test_every_option_exists(self):
        """Checks every command of the program in a piece, in a text line or in a list of figures."""
        seen = 0
        for page in PAGES:
            text = (DOCS / page).read_text()
            lines = [line for _, piece in pieces(page) for line in piece.replace("\\\n", " ").splitlines()]
            for code in lines + re.findall(r"`([^`\n]+)`", FENCED.sub("", text)):
                for program, said in re.findall(r"(?:^|[ /\"])(wholehand(?:-clinic)?)((?: [^#|&]*)?)(?=$|[#|&\"])", code):
                    options = re.findall(r"(?<!\S)\[?(--[a-z][a-z-]*)", said)
                    if said.strip():
                        known = self.options_of(program, said.split())
                        self.assertLessEqual(set(options), known, f"{page}: {code}")
                        seen += len(options)
        self.assertGreater(seen, 80, "the commands are not found any more")


class Files(AppTest):
    """Pieces that need no device."""

    def setUp(self):
        super().setUp()
        for name in ("config", "data"):  # folders of the sources
            (self.folder / name).symlink_to(SOURCE / name)

    def do(self, words, *more, code=DONE):
        self.assertEqual(words[0], "wholehand")
        return self.expect(self.run_app(*words[1:], *more), code)

    def test_links_of_a_patient_are_read(self):
        text = (CONFIG / "patients/stiff-adult.toml").read_text()
        self.expect(self.run_app("validate", self.write("mine.toml", text + pieces("patients.md")[0][1])), DONE, "ok  patient")

    def test_exercises_are_run(self):
        for line in pieces("exercises.md")[0][1].splitlines():
            command, _, _ = line.partition("   ")
            names = [path.stem for path in sorted((CONFIG / "exercises").glob("*.toml"))] if "my-exercise" in line else [None]
            for name in names:
                self.do([name if word == "my-exercise" else word for word in command.split()], "--simulated-clock", "--duration",
                        0.05)

    def test_c_code_of_the_frame_compiles(self):
        firmware = SOURCE / "drivers/frame/firmware"
        self.write("board.c", '#include "firmware.h"\nfloat counts(void); void motor(int, float); void uart_put(const uint8_t*, size_t);\n'
                   + pieces("frame.md")[1][1] + "const fw_board mine = {.measure = measure, .drive = drive, .control = control, .send = send};\n")
        done = subprocess.run(["cc", "-std=c99", "-Wall", "-Werror", "-fsyntax-only", f"-I{firmware}", f"-I{SOURCE}/src/driver_abi",
                               "board.c"], cwd=self.folder, text=True, capture_output=True)
        self.assertEqual(done.returncode, 0, done.stderr)

    def test_embedding_lines_are_those_of_the_tested_project(self):
        """embed.sh builds the program with the installed package."""
        consumer = (SOURCE / "tests/examples/consumer/CMakeLists.txt").read_text().splitlines()
        for line in pieces("embedding.md")[1][1].splitlines():
            self.assertIn(line.partition("#")[0].strip().replace("(mine ", "(consumer "), consumer)

    def test_own_files_can_be_used(self):
        (self.folder / "config").unlink()
        shutil.copytree(CONFIG, self.folder / "config")
        for kind in ("devices", "rendering"):
            shutil.copy(CONFIG / kind / "desktop-3axis.toml", self.folder / "config" / kind / "mine.toml")
        validate, run = commands("program.md")
        self.expect(self.do(validate), DONE, "ok  device", "ok  rendering")
        self.do(run, "--simulated-clock", "--duration", 0.05)

    def test_mesh_with_a_hollow_is_decomposed(self):
        points, faces = CUP
        self.write("mug.obj", obj([[1000.0 * x for x in point] for point in points], faces))
        decompose, run = commands("program.md", 1)
        self.do(decompose)
        self.do(run, "--simulated-clock", "--duration", 0.1)

    def test_data_that_matlab_reads_exists(self):
        """Debian has no MATLAB: checks that the data which its lines read exist, with names and units."""
        asked = re.findall(r"(h5read|h5readatt)\('(run.h5)', '([^']+)'(?:, '(\w+)')?\)", pieces("recording.md")[1][1])
        self.assertEqual(len(asked), 4)
        with h5py.File(self.record(duration=0.1), "r") as file:
            for function, _, dataset, attribute in asked:
                self.assertGreater(len(file[dataset].attrs[attribute] if attribute else file[dataset]), 5, (function, dataset))

    def test_octave_lines_run_slow(self):
        ticks = len(h5py.File(self.record(duration=0.1), "r")["ticks/tick"])
        program = "function plot(x, y) printf('%d ', numel(x), size(y)); end\n" + pieces("recording.md")[2][1]
        said = subprocess.run(["octave-cli", "--no-init-file", "--eval", program], cwd=self.folder, check=True, text=True,
                              capture_output=True).stdout
        self.assertEqual(said.split(), [str(ticks), "6", str(ticks)])  # axes x ticks

    def test_black_box_commands_run(self):
        run = self.start_app(*FREE_RUN, "--no-rehearsal", "--duration", 60, "--record", "run.h5")
        self.wait_until_it_renders(run)
        run.send_signal(signal.SIGSEGV)
        run.communicate(timeout=HANG_S)
        look, *others = commands("recording.md", 3)
        self.do(look, "--speed", 1000)
        for command in others:
            self.do(command)
        for name in ("seconds.h5", "run.html"):
            self.assertTrue((self.folder / name).is_file(), name)

    def test_sweep_grid_runs(self):
        self.write("grid.toml", pieces("sweeps.md")[1][1])
        shutil.copy(CONFIG / "hands/adult-median-right.toml", self.folder / "mine.toml")
        self.expect(self.run_app("sweep", "grid.toml", "--out", "F.h5"), DONE, "Which hands hold a cylinder?: 6 cells")

    def test_shipped_sweep_is_drawn_slow(self):
        command, = commands("sweeps.md")
        self.do(command)
        self.assertTrue((self.folder / "grasps.html").is_file())

    def test_example_datagram_matches_the_text(self):
        said = datagrams.datagram(datagrams.STATE, b"abc", flags=1, key=0x0102030405060708, sequence=5, number=7, sent=-2, echo=3, age=4)
        self.assertEqual(bytes.fromhex(pieces("udp.md")[0][1]), said)

    def test_composite_file_is_read(self):
        """Reads it up to the device of its first part, which is not connected."""
        self.write("pair.toml", pieces("composite.md")[0][1].replace("/dev/ttyACM0", "/dev/none"))
        self.expect_refused(self.run_app("run", "--driver", "composite", "--driver-settings", "pair.toml", "--port", 0),
                            "frame: no device was found at serial:/dev/none")

    def test_gains_of_a_host_match_the_page(self):
        device = (CONFIG / "devices/desktop-3axis.toml").read_text()
        self.write("mine.toml", re.sub(r"(?m)^output_delay_ticks = \d+", "output_delay_ticks = 2", device))
        page = (SOURCE / "docs/device-host.md").read_text()
        command = shlex.split(re.search(r"`(wholehand certify [^`]*)`", page)[1])
        self.assertIn(pieces("device-host.md")[1][1].strip(), self.do(command, code=1).out)
        soft = re.sub(r"(?m)^k_pm_n_m = \S+", re.search(r"`(k_pm_n_m = 271.0)`", page)[1],
                      (CONFIG / "rendering/desktop-3axis.toml").read_text())
        self.do([self.write("my-gains.toml", soft) if word.endswith("rendering/desktop-3axis.toml") else word for word in command])


class Devices(DeviceTest):
    """Drivers with fake devices."""

    def setUp(self):
        super().setUp()
        (self.folder / "build").mkdir()
        (self.folder / "build/release").symlink_to(BUILT)
        for name in ("src", "examples", "config"):  # folders of the sources
            (self.folder / name).symlink_to(SOURCE / name)

    def start(self, words, **how):
        self.assertEqual(words[0], "wholehand")
        return self.start_app(*words[1:], **how)

    def background(self, *command, until, **how):
        """Starts a program beside the test and waits for an output; returns the output."""
        log = self.folder / f"{pathlib.Path(command[0]).name}.log"
        with log.open("w") as out:
            process = subprocess.Popen([*map(str, command)], cwd=self.folder, stdin=subprocess.PIPE, stdout=out, stderr=out, **how)
        self.addCleanup(process.wait)
        self.addCleanup(process.stdin.close)
        self.addCleanup(process.terminate)
        self.wait_until(process, lambda: until in log.read_text(), log.read_text)
        self.assertIn(until, log.read_text())
        return log.read_text()

    def renders(self, command, ticks=100):
        """Arms at the page and waits for so many ticks."""
        run = self.start([*command, "--port", "0"])
        first = run.stdout.readline()
        self.assertIn("http", first, run)
        self.page = client.Page(int(first.split(":")[2].rstrip("/\n")))
        self.page.hold_controls()
        self.arm()
        self.wait_for_ticks(run, ticks)
        run.send_signal(signal.SIGINT)
        said = "".join(run.communicate(timeout=HANG_S))
        self.assertEqual(run.returncode, INTERRUPTED, said)

    def compile_rails(self):
        compile_it, conform, run_it = commands("drivers.md")
        subprocess.run(compile_it, cwd=self.folder, check=True)
        return conform, run_it

    def test_first_commands_lead_to_a_rendering_device(self):
        conform, run_it = self.compile_rails()
        self.expect(self.run_app(*conform[1:]), DONE, " 0 failed")
        self.renders([*run_it, "--driver-settings", "watchdog_ms=2000"])  # tolerates stalls of this machine

    def test_conformance_commands_run(self):
        self.compile_rails()
        for command in commands("drivers.md", 2):
            # Checks with motion depend on time, so only the first check is run.
            only = ("--only", "boundary.") if "--allow-effort" in command else ()
            self.expect(self.run_app(*command[1:], *only), DONE, " 0 failed")

    def test_missing_passport_is_refused_with_the_documented_remedy(self):
        _, run_it = self.compile_rails()
        run_it.remove("--without-passport")
        self.expect_refused(self.run_app(*run_it[1:]), "device rails-0001 has no passport", "--without-passport")

    def test_commissioning_starts_with_the_documented_commands(self):
        shutil.copy(CONFIG / "devices/desktop-3axis.toml", self.folder / "mine.toml")
        shutil.copy(DRIVERS / "rails.so", self.folder / "mine.so")
        for piece, serial in ((0, "rails-0001"), (1, "simulated")):
            command, = commands("commissioning.md", piece)
            self.expect(self.run_app(*command[1:]), 1, "Step 1 of 12: identify", serial, "Not finished")
        command, = commands("commissioning.md", 2)
        self.expect_refused(self.run_app(*command[1:]), "rails-0001.passport.toml")

    def test_loop_moves_the_device_of_a_host(self):
        self.compile_rails()
        name = f"test-documented-{os.getpid()}"
        for leftover in (name, name + ".lock"):
            self.addCleanup(pathlib.Path("/dev/shm", "wholehand-" + leftover).unlink, missing_ok=True)
        host, run_it = ([name if word == "desk" else word for word in words] for words in commands("device-host.md"))
        shutil.copy(self.config_file("devices", "desktop-3axis", output_delay_ticks="2"), self.folder / "mine.toml")
        gains = re.sub(r"(?m)^k_pm_n_m = \S+", "k_pm_n_m = 271.0", (CONFIG / "rendering/desktop-3axis.toml").read_text())
        self.write("my-gains.toml", gains)
        self.background(BINARY, *host[1:], "--driver-settings", "watchdog_ms=2000", until=f"{name}: holds")
        self.expect_refused(self.run_app(*run_it[1:]), "device rails-0001 has no passport")
        self.renders([*run_it, "--without-passport"], ticks=20)

    def test_frame_commands_run_without_hardware(self):
        with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as free:
            free.bind(("127.0.0.1", 0))
            port = str(free.getsockname()[1])
        firmware, run_it = ([word.replace("7777", port) for word in words] for words in commands("frame.md"))
        self.background(BUILT / pathlib.Path(firmware[0]).name, *firmware[1:], "silence_ms=2000", until="at udp:")
        self.renders(run_it)
        self.assertIn("rendering", (self.folder / "frame_firmware.log").read_text(), ALWAYS)

    def test_vendor_devices_are_found_by_their_commands(self):
        """Runs the commands up to the missing passport, which they do not override."""
        port = self.background(BUILT / "fake_hand", until="\n").split()[0]
        hand = ("finger_flexion", "thumb_circumduction", "thumb_flexion")
        shutil.copy(self.config_file("devices", "lambda-pride", hand), self.folder / "mine.toml")
        shutil.copy(self.config_file("rendering", "lambda-pride", hand), self.folder / "my-gains.toml")
        shutil.copy(SOURCE / "drivers/moteus/hand.toml", self.folder / "my-hand.toml")
        moteus, = commands("moteus.md")
        self.expect_refused(self.run_app(*(word.replace("/dev/ttyACM0", port) for word in moteus[1:])), "has no passport")

        shutil.copy(self.config_file("devices", "desktop-3axis"), self.folder / "mine.toml")
        shutil.copy(CONFIG / "rendering/desktop-3axis.toml", self.folder / "my-gains.toml")
        quick = (SOURCE / "drivers/force_dimension/lambda-7.toml").read_text().replace("delay_s = 0.001 ", "delay_s = 0.0004 ")
        self.write("my-lambda.toml", quick)  # the delay with the host's two cycles stays within the stated period
        name = f"test-documented-{os.getpid()}-arm"
        for leftover in (name, name + ".lock"):
            self.addCleanup(pathlib.Path("/dev/shm", "wholehand-" + leftover).unlink, missing_ok=True)
        export, host, run_it = ([name if word == "arm" else word for word in words] for words in commands("force-dimension.md"))
        variable, _, _ = export[1].partition("=")
        sdk = {**os.environ, variable: str(BUILT / "fake_sdk/current")}
        self.background(BINARY, *host[1:], until=f"{name}: holds", env=sdk)
        self.expect_refused(self.run_app(*run_it[1:]), "has no passport")


if __name__ == "__main__":
    main()
