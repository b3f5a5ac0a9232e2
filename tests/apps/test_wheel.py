"""The Python package installed by pip, into environments without access to this folder or a network."""
import os
import pathlib
import re
import subprocess
import sys
import tempfile

import app
from app import BINARY, SOURCE, AppTest, main

PROJECT = BINARY.parent / "python"
OURS = ("numpy", "flatbuffers", "websockets", "h5py", "pandas", "xarray", "wholehand._rig")  # its imports


def said(*command, **how):
    environment = {name: value for name, value in os.environ.items() if not name.startswith(("PYTHON", "PIP_"))}
    return app.said(*command, env=environment, **how)


class Wheel(AppTest):
    @classmethod
    def setUpClass(cls):
        super().setUpClass()
        made = tempfile.TemporaryDirectory(prefix="wholehand-wheel-")
        cls.addClassCleanup(made.cleanup)
        cls.made = pathlib.Path(made.name)
        said(sys.executable, "-B", SOURCE / "clients/python/make_wheel.py", PROJECT, cls.made)
        cls.sdist, = cls.made.glob("*.tar.gz")
        cls.wheel, = cls.made.glob("*.whl")
        cls.python = cls.environment("debian", "--system-site-packages")  # the dependencies come from Debian

    @classmethod
    def environment(cls, name, *options):
        said(sys.executable, "-m", "venv", *options, cls.made / name)
        return cls.made / name / "bin/python"

    def install(self, python, *what):
        said(python, "-m", "pip", "install", "--no-index", "--disable-pip-version-check", "--force-reinstall", "--no-deps", *what)

    def in_it(self, python, program):
        return said(python, "-c", program, cwd=self.folder).split()

    def test_wheel_installs_client_and_rigs_with_their_files(self):
        self.assertRegex(self.wheel.name, r"-cp3\d+-cp3\d+-linux_")
        self.install(self.python, self.wheel)
        said(self.python, "-m", "pip", "install", "--no-index", self.wheel)  # all dependencies are installed
        version, where, ran, table = self.in_it(self.python, "import wholehand; from wholehand.rig import Rig, shipped\n"
                                                "import wholehand.client, wholehand.connection\n"
                                                "print(wholehand.__version__, wholehand.__file__, Rig(exercise='cocktail-bar')."
                                                "step(n=20), shipped('config/scenes/table.toml'))")
        self.assertIn(f"project(wholehand VERSION {version} ", (SOURCE / "CMakeLists.txt").read_text())
        self.assertEqual(ran, "20")
        for path in (where, table):
            self.assertTrue(path.startswith(str(self.made / "debian")), path)
        self.assertEqual(pathlib.Path(table).read_bytes(), (SOURCE / "config/scenes/table.toml").read_bytes())

    def test_packages_of_a_minimal_debian_contain_every_library(self):
        """All linked libraries come with the packages that the manual names, or with apt and python3."""
        named = re.search(r"apt-get install --no-install-recommends (python3-venv .*)", (SOURCE / "clients/python/README.md").read_text())[1]
        module, = (PROJECT / "wholehand").glob("_rig.*.so")
        needed = re.findall(r"\(NEEDED\).*\[(.*)\]", said("readelf", "-d", module))
        self.assertGreater(len(needed), 8)
        found = dict(re.findall(r"(\S+) => (/\S+)", said("ldd", module)))
        for library in needed:
            path = os.path.realpath(found[library])
            package = subprocess.run(["dpkg", "-S", path.removeprefix("/usr"), path], capture_output=True, text=True).stdout.partition(":")[0]
            self.assertIn(package, [*named.split(), "libc6", "libgcc-s1", "libstdc++6", "zlib1g", "libssl3"], library)

    def test_five_lines_of_the_readme_plot_a_grasp(self):
        self.install(self.python, self.wheel)
        lines = (SOURCE / "clients/python/README.md").read_text().split("## A plot of a grasp")[1].split("```")[3]
        program = lines.removeprefix("python\n")
        self.assertEqual(len(program.splitlines()), 5)
        # A stand-in for matplotlib, which is not needed otherwise: prints the data to be drawn.
        (self.folder / "matplotlib").mkdir()
        (self.folder / "matplotlib/__init__.py").write_text("")
        (self.folder / "matplotlib/pyplot.py").write_text("plot = lambda y: print(*y)\nsavefig = lambda file: print(file)\n")
        *force_n, file = self.in_it(self.python, program)
        self.assertEqual((len(force_n), float(force_n[0]), file), (800, 0.0, "grasp.png"))
        held = sum(float(f) > 5.0 for f in force_n)  # samples of 10 ms each
        self.assertGreater(held, 100, "the recorded reach holds the box for a second")

    def test_sdist_builds_a_client_for_any_machine(self):
        said(self.python, "-m", "pip", "wheel", "--no-index", "--no-build-isolation", "--no-deps", "-w", self.folder, self.sdist)
        built, = self.folder.glob("*.whl")
        self.assertRegex(built.name, "-py3-none-any.whl$")
        bare = self.environment("bare")
        self.install(bare, built)
        self.assertEqual(self.in_it(bare, "import wholehand; print(len(wholehand.__version__.split('.')))"), ["3"])
        refused = subprocess.run([bare, "-c", "import wholehand; wholehand.open('run.h5')"], capture_output=True, text=True)
        self.assertIn("No module named 'h5py'", refused.stderr)
        self.install(self.python, built)
        refused = subprocess.run([self.python, "-c", "import wholehand.rig"], capture_output=True, text=True, cwd=self.folder)
        self.assertIn("wholehand.rig needs the module _rig", refused.stderr)
        self.in_it(self.python, "import wholehand.client, wholehand.bodies, wholehand.kinematics, wholehand.recording")

    def test_import_loads_only_needed_modules(self):
        self.install(self.python, self.wheel)
        for module, needs in (("wholehand", []), ("wholehand.client", ["numpy", "flatbuffers", "websockets"]),
                              ("wholehand.rig", ["numpy", "wholehand._rig"]), ("wholehand.environment", ["numpy", "wholehand._rig"]),
                              ("wholehand.recording", ["numpy", "h5py"])):
            taken = self.in_it(self.python, f"import sys, {module}; print(*(m for m in {OURS} if m in sys.modules))")
            self.assertEqual(taken, needs, module)


if __name__ == "__main__":
    main()
