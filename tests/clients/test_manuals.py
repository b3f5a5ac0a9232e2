"""Checks the code pieces in the clients' manuals that need no engine. test_manuals.py"""
import pathlib
import re
import unittest

SOURCE = pathlib.Path(__file__).resolve().parents[2]
CLIENTS = SOURCE / "clients"
MANUALS = [*CLIENTS.glob("*/README.md"), *CLIENTS.glob("unity/*/README.md")]


class Manuals(unittest.TestCase):
    def test_python_pieces_compile_unchanged(self):
        pieces = re.findall(r"^```python\n(.*?)^```", (CLIENTS / "python/README.md").read_text(), re.S | re.M)
        self.assertGreater(len(pieces), 3)
        for piece in pieces:
            compile(piece, "clients/python/README.md", "exec")

    def test_signals_of_godot_are_documented_with_their_arguments(self):
        manual = (CLIENTS / "godot/README.md").read_text()
        signals = re.findall(r"^signal (\w+)(\(.*\))?", (CLIENTS / "godot/addons/wholehand/connection.gd").read_text(), re.M)
        self.assertGreater(len(signals), 8)
        for name, arguments in signals:
            self.assertIn(f"`{name}{arguments}`", manual)

    def test_scenes_are_given_by_name_not_by_path(self):
        """A path would work only from the repository's root."""
        self.assertGreater(len(MANUALS), 4)
        for manual in MANUALS:
            self.assertNotIn("--exercise config/", manual.read_text(), manual)


if __name__ == "__main__":
    unittest.main()
