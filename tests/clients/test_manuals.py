"""The manuals of the clients: pieces that can be checked without their engines. test_manuals.py"""
import pathlib
import re
import unittest

SOURCE = pathlib.Path(__file__).resolve().parents[2]
CLIENTS = SOURCE / "clients"
MANUALS = [*CLIENTS.glob("*/README.md"), *CLIENTS.glob("unity/*/README.md")]


class Manuals(unittest.TestCase):
    def test_python_compiles_as_it_stands(self):
        pieces = re.findall(r"^```python\n(.*?)^```", (CLIENTS / "python/README.md").read_text(), re.S | re.M)
        self.assertGreater(len(pieces), 3)
        for piece in pieces:
            compile(piece, "clients/python/README.md", "exec")

    def test_godots_signals_are_documented_with_their_arguments(self):
        manual = (CLIENTS / "godot/README.md").read_text()
        signals = re.findall(r"^signal (\w+)(\(.*\))?", (CLIENTS / "godot/addons/wholehand/connection.gd").read_text(), re.M)
        self.assertGreater(len(signals), 8)
        for name, arguments in signals:
            self.assertIn(f"`{name}{arguments}`", manual)

    def test_scenes_are_named_as_anywhere(self):
        """A path would need the repository's root as working folder."""
        self.assertGreater(len(MANUALS), 4)
        for manual in MANUALS:
            self.assertNotIn("--exercise config/", manual.read_text(), manual)


if __name__ == "__main__":
    unittest.main()
