"""The Godot addon, run by Debian's godot3-server against the program itself (godot/run.gd).

test_godot.py <wholehand> <folder to build in> [Class.test]. Exit code 77: godot3-server is not installed."""
import os
import pathlib
import re
import shutil
import subprocess
import sys
import tempfile
import unittest

SOURCE = pathlib.Path(__file__).resolve().parents[2]
SCRIPT = SOURCE / "scripts/godot_addon.py"
sys.path.insert(0, str(SOURCE / "tests/support"))
from watched_main import FULL, HANG_S, main  # noqa: E402
# The dummy renderer of godot3-server accesses a mesh again that was freed with its instance.
OF_THE_SERVER = r"ERROR: (getornull: Condition \"!id_map|mesh_get_\w+_count: Condition \"!m\")"
MUTATIONS = 100_000 if FULL else 2_000


class Program:
    """Runs `wholehand run` with pages; it is killed at the end of a test at the latest."""

    def __init__(self, test, *arguments, port=0):
        self.process = subprocess.Popen([PROGRAM, "run", "--port", str(port), "--no-rehearsal", *arguments], text=True,
                                        stdin=subprocess.DEVNULL, stdout=subprocess.PIPE, stderr=subprocess.DEVNULL)
        test.addCleanup(self.end)
        line = self.process.stdout.readline()
        test.assertRegex(line, r"^http://.*:\d+/$")
        self.port = int(re.search(r":(\d+)/", line).group(1))

    def end(self):
        if self.process.poll() is None:
            self.process.kill()
            self.process.communicate()


def setUpModule():
    made = subprocess.run([sys.executable, "-B", SCRIPT, "make", PROJECT], text=True, capture_output=True)
    if made.returncode != 0:
        raise AssertionError(made.stderr)
    for file in (SOURCE / "tests/clients/godot").iterdir():
        shutil.copyfile(file, PROJECT / file.name)
    # The code pieces of the manual, unchanged, as the script of one node in a game that has a ring and a world.
    manual = (SOURCE / "clients/godot/README.md").read_text(encoding="utf-8")
    pieces = re.findall(r"^```gdscript\n(.*?)^```", manual, re.S | re.M)
    if len(pieces) != 2:
        raise AssertionError(f"{len(pieces)} pieces of GDScript in the manual; the_manuals_pieces_are_played knows 2")
    world = 'const World = preload("res://addons/wholehand/world.gd")\nvar world = World.new()\n'
    (PROJECT / "manual.gd").write_text("extends Node\n" + world + "\n".join(pieces), encoding="utf-8")
    (PROJECT / "ring.tscn").write_text('[gd_scene format=2]\n\n[node name="Ring" type="Spatial"]\n')


class PlayedInGodot:
    paced = True

    def start(self, test, port, **more):
        home = tempfile.mkdtemp(prefix="wholehand-test-")
        self.addCleanup(shutil.rmtree, home)
        os.makedirs(f"{home}/godot/app_userdata/Tests of the Wholehand addon/logs")
        environment = {**os.environ, "HOME": home, "XDG_DATA_HOME": home, "XDG_CONFIG_HOME": home, "XDG_CACHE_HOME": home,
                       "LANG": "en_US.UTF-8", "LC_ALL": "en_US.UTF-8", "WHOLEHAND_TEST": test, "WHOLEHAND_PORT": str(port),
                       "WHOLEHAND_SEED": os.environ.get("WHOLEHAND_SEED", "1"), "WHOLEHAND_MUTATIONS": str(MUTATIONS), **more}
        game = subprocess.Popen(["godot3-server", "--path", PROJECT, "-s", "res://run.gd"], env=environment, text=True,
                                stdin=subprocess.DEVNULL, stdout=subprocess.PIPE, stderr=subprocess.STDOUT)
        self.addCleanup(game.communicate)
        self.addCleanup(game.kill)
        return game

    def finish(self, game, expected=r"(?!)"):
        """@param expected errors of the engine that the test causes on purpose"""
        said, _ = game.communicate(timeout=HANG_S)
        print("".join(line + "\n" for line in said.splitlines() if line.startswith("figure:")), end="")
        self.assertEqual(game.returncode, 0, said)
        # Script errors only end the function in which they happen, so they must be searched for in the output.
        errors = [line for line in said.splitlines() if ("ERROR" in line or line.startswith("FAILED"))
                  and not re.match(OF_THE_SERVER, line)]
        self.assertEqual([error for error in errors if not re.match(expected, error)], [], said)
        return errors


def of_run_gd(test, *arguments):
    def run(self):
        self.finish(self.start(test, Program(self, *arguments).port))
    return run


TABLE = ("--exercise", str(SOURCE / "tests/clients/game_table.toml"))  # a scene with its own bodies
AGAINST_THE_PROGRAM = {
    "drawn_where_the_program_says": (),
    "a_predicted_hand_is_ahead_of_the_state": (),
    "every_shape_has_its_mesh": ("--scene", str(SOURCE / "config/scenes/table.toml")),
    "states_are_cheap": (),
    "damaged_messages_are_ignored": (),
    "commands_are_obeyed_or_refused_with_the_reason": ("--wait",),
    "a_game_that_hangs_loses_the_controls": ("--wait",),
    "a_ball_falls_rests_and_is_removed": ("--wait", *TABLE),
    "a_ball_that_falls_on_the_hand_tells_its_touch": ("--wait", *TABLE),
    "a_driven_body_follows_its_target": ("--wait", *TABLE),
    "bodies_beyond_the_slots_are_one_node_in_and_out_of_reach": ("--wait", *TABLE),
    "a_thousand_bodies_are_cheap": ("--wait", *TABLE),
    "refused_orders_say_why": ("--wait", *TABLE),
    "the_manuals_pieces_are_played": ("--wait", "--exercise", "game-scene"),  # the options that the manual gives
}
AgainstTheProgram = type("AgainstTheProgram", (PlayedInGodot, unittest.TestCase), {
    f"test_{name}": of_run_gd(name, *arguments) for name, arguments in AGAINST_THE_PROGRAM.items()})


class OtherWays(PlayedInGodot, unittest.TestCase):
    def test_axes_follow_godots_convention(self):
        self.finish(self.start("axes_are_godots", 1))

    def test_nodes_without_connection_say_what_to_do(self):
        errors = self.finish(self.start("a_hand_without_connection_says_what_to_do", 1), "ERROR: call: Wholehand ")
        self.assertEqual(len(errors), 2, errors)
        for error, node in zip(errors, ("hand LostHand", "world LostWorld")):
            self.assertIn(f"Wholehand {node} has no connection: set connection_path", error)

    def test_nobody_there_is_reported_once(self):
        self.finish(self.start("nobody_there_is_told_once", 1))

    def test_restarted_program_is_found_again(self):
        program = Program(self, "--wait")
        game = self.start("a_program_that_is_restarted_is_found_again", program.port)
        while (line := game.stdout.readline()) != "connected\n":
            self.assertNotEqual(line, "", "the game ended")
        program.end()
        Program(self, "--wait", port=program.port)
        self.finish(game)

    def test_token_grants_access(self):
        token = "a-rather-long-secret-1234"
        program = Program(self, "--wait", "--token", token)
        self.finish(self.start("a_token_opens_the_program", program.port, WHOLEHAND_TOKEN=token),
                    "ERROR: (_verify_headers|_do_handshake): Invalid")


class Addon(unittest.TestCase):
    """scripts/godot_addon.py."""

    def test_other_version_than_the_projects_is_refused(self):
        with tempfile.TemporaryDirectory(prefix="wholehand-test-") as folder:
            tree = pathlib.Path(folder)
            for name in ("scripts/godot_addon.py", "scripts/gdscript4.py", "CMakeLists.txt"):
                (tree / name).parent.mkdir(exist_ok=True)
                shutil.copyfile(SOURCE / name, tree / name)
            shutil.copytree(SOURCE / "clients/godot/addons", tree / "clients/godot/addons")
            plugin = tree / "clients/godot/addons/wholehand/plugin.cfg"
            plugin.write_text(re.sub('version=".*"', 'version="7.0"', plugin.read_text()))
            checked = subprocess.run([sys.executable, "-B", tree / "scripts/godot_addon.py", "check"], text=True,
                                     capture_output=True)
        self.assertEqual(checked.returncode, 1)
        self.assertRegex(checked.stderr, r"plugin.cfg: version is '7.0', that of the project '[\d.]+' \(CMakeLists.txt\)")


if __name__ == "__main__":
    if len(sys.argv) < 3:
        sys.exit(__doc__)
    PROGRAM, PROJECT = sys.argv[1], pathlib.Path(sys.argv[2]).resolve()
    if not shutil.which("godot3-server"):
        print("skipped: godot3-server is not installed; install it: apt-get install godot3-server")
        sys.exit(77)
    shutil.rmtree(PROJECT, ignore_errors=True)
    PROJECT.mkdir(parents=True)
    main(sys.argv[3:])
