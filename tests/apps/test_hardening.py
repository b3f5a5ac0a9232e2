"""Hardening of a release build by compiler and linker, checked with readelf and nm."""
import pathlib
import re
import subprocess
import unittest

from app import BINARY, LAB, main

BUILD = BINARY.parent
SHIPPED = ["composite", "force_dimension", "frame", "moteus"]
PROGRAMS = [BINARY, BUILD / "wholehand-tools", BUILD / "wholehand-read-mesh", *(BUILD / "drivers" / f"{name}.so" for name in SHIPPED)]
ASSERTION = re.compile(r"__glibcxx_assert_fail|__replacement_assert")
# Libraries that only the tick uses.
TICK = ["loop_control", "loop_dynamics", "loop_safety", "loop_physics_bullet", "loop_renderer"]


def said(*command):
    return subprocess.run(command, capture_output=True, text=True, check=True).stdout


class Hardening(unittest.TestCase):
    def check_programs(self, pattern, *command):
        for program in PROGRAMS:
            with self.subTest(program=program.name):
                self.assertRegex(said(*command, program), pattern)

    def test_addresses_are_random(self):
        self.check_programs(r"Type:\s+DYN", "readelf", "-hW")

    def test_linker_tables_are_read_only_from_the_start(self):
        self.check_programs("GNU_RELRO", "readelf", "-lW")
        self.check_programs(r"BIND_NOW|FLAGS_1.*NOW", "readelf", "-dW")

    def test_the_stack_cannot_be_executed(self):
        self.check_programs(r"GNU_STACK.* RW ", "readelf", "-lW")

    def test_stack_and_buffers_are_guarded(self):
        symbols = said("nm", "-D", BINARY)
        self.assertIn("__stack_chk_fail", symbols)
        self.assertRegex(symbols, r"__(mem|str|s?n?printf|fprintf|vsnprintf|read)\w*_chk")

    def test_index_checks_are_active_except_in_the_tick(self):
        self.assertRegex(said("nm", "-D", BINARY), ASSERTION)
        libraries = [BUILD / pathlib.Path("src", *name.split("_")) / f"libwholehand_{name}.a" for name in TICK]
        for library in libraries + ([BUILD / "lab/libwholehand_lab.a"] if LAB else []):
            with self.subTest(library=library.name):
                self.assertNotRegex(said("nm", library), ASSERTION)


if __name__ == "__main__":
    main()
