"""The Unity package without Unity: built and checked; compiled by mono, one assembly per .asmdef file,
against a stand-in for UnityEngine (unity/stub); and run frame by frame against running programs (unity/*.cs).

test_unity.py <udp_stand_in> <wholehand> <folder to build in>. Exit code 77: mono or flatc is not installed."""
import json
import os
import pathlib
import re
import shutil
import subprocess
import sys
import tarfile
import tempfile
import unittest

SOURCE = pathlib.Path(__file__).resolve().parents[2]
TESTS = SOURCE / "tests/clients"
SCRIPT = SOURCE / "scripts/unity_package.py"
sys.path[:0] = [str(SCRIPT.parent), str(SOURCE / "tests/support")]
import unity_package  # noqa: E402
from watched_main import main  # noqa: E402

NAME = "org.wholehand.client"
MANUALS = (SOURCE / "clients/csharp/README.md", SOURCE / f"clients/unity/{NAME}/README.md")
STUBS = {"UnityEngine.TestRunner", "UnityEditor.TestRunner"}  # contained in the stub of NUnit


def package_script(*arguments):
    return subprocess.run([sys.executable, "-B", SCRIPT, *arguments], text=True, capture_output=True)


def compile_library(target, sources, references, *more):
    done = subprocess.run(["mcs", "-langversion:7", "-debug", "-nologo", f"-out:{target}", *more,
                           *(f"-r:{reference}" for reference in references), *sources], text=True, capture_output=True)
    if done.returncode != 0:
        raise AssertionError(f"{target.name}:\n{done.stdout}{done.stderr}")


def setUpModule():
    global ARCHIVE
    made = package_script("make", BUILD)
    if made.returncode != 0:
        raise AssertionError(made.stderr)
    ARCHIVE = pathlib.Path(made.stdout.strip())


class Package(unittest.TestCase):
    """scripts/unity_package.py."""

    package = property(lambda self: BUILD / NAME)

    def copied(self):
        folder = tempfile.TemporaryDirectory(prefix="wholehand-test-")
        self.addCleanup(folder.cleanup)
        return shutil.copytree(self.package, pathlib.Path(folder.name) / NAME)

    def test_package_is_valid(self):
        for package in (self.package, SOURCE / "clients/unity" / NAME):
            checked = package_script("check", package)
            self.assertEqual(checked.returncode, 0, checked.stderr)

    def test_archive_has_the_layout_of_upm(self):
        version = re.search(r"VERSION ([\d.]+)", (SOURCE / "CMakeLists.txt").read_text().split("project(")[1]).group(1)
        self.assertEqual(ARCHIVE.name, f"{NAME}-{version}.tgz")
        with tarfile.open(ARCHIVE) as archive:
            files = {name.removeprefix("package/"): archive.extractfile(name).read() for name in archive.getnames()
                     if name.startswith("package/")}
            self.assertEqual(len(files), len(archive.getnames()))
        self.assertEqual(json.loads(files["package.json"])["version"], version)
        for source in (SOURCE / "clients/csharp/Wholehand").glob("*.cs"):
            self.assertEqual(files[f"Runtime/Client/{source.name}"], source.read_bytes(), "the C# client as it is")
        self.assertIn("Apache License", files["LICENSE.md"].decode())
        for name in files:
            if not name.endswith(".meta"):
                self.assertIn(f"{name}.meta", files)

    def test_second_build_has_the_same_bytes(self):
        made = package_script("make", self.copied().parent / "again")
        self.assertEqual(pathlib.Path(made.stdout.strip()).read_bytes(), ARCHIVE.read_bytes())

    def test_invalid_package_is_refused_by_name(self):
        meta, other = "Runtime/WholehandBody.cs.meta", "Runtime/WholehandWorld.cs.meta"
        for name, change, texts in (
                ("Runtime/WholehandHand.cs.meta", None, ("Runtime/WholehandHand.cs", "WholehandHand.cs.meta is missing",
                                                         "unity_package.py meta")),
                ("Runtime/Protocol.meta", None, ("Runtime/Protocol: its file Protocol.meta is missing",)),
                ("Editor/WholehandMenu.cs", None, ("WholehandMenu.cs.meta: there is no WholehandMenu.cs",)),
                ("package.json", lambda text: text.replace('"version": "0', '"version": "7', 1),
                 ("package.json: version is '7", "CMakeLists.txt")),
                ("package.json", lambda _: "{", ("package.json", "a package needs a manifest in JSON")),
                (other, lambda _: (self.package / meta).read_text(),
                 ("WholehandWorld.cs.meta: guid", "is that of Runtime/WholehandBody.cs, too")),
                (meta, lambda text: re.sub("guid: .*", "guid: " + "0" * 32, text),
                 ("WholehandBody.cs.meta: guid 0000", "is not the one of this path")),
                (meta, lambda text: re.sub("guid: .*", "guid: 12", text), ("guid is '12', not 32 hexadecimal digits",))):
            with self.subTest(texts[-1]):
                copy = self.copied()
                if change:
                    (copy / name).write_text(change((copy / name).read_text()))
                else:
                    (copy / name).unlink()
                faults = unity_package.faults_of(copy, unity_package.project_version())
                self.assertEqual(len(faults), 1, faults)
                for text in texts:
                    self.assertIn(text, faults[0])
        checked = package_script("check", copy)  # checks the last copy
        self.assertEqual(checked.returncode, 1)
        self.assertEqual(len(checked.stderr.splitlines()), 1, checked.stderr)


class Assemblies(unittest.TestCase):
    """Each .asmdef is compiled as a separate assembly with exactly its references."""

    paced = True

    def test_assemblies_compile_and_run(self):
        out, engine, editor, nunit, built = assemblies(self)
        tests = out / "HeadlessTests.exe"
        shared = [TESTS / "csharp/Runner.cs", TESTS / "csharp/RealProgram.cs", TESTS / "csharp/StandIn.cs"]
        compile_library(tests, [*sorted((TESTS / "unity").glob("*.cs")), *shared], [engine, editor, nunit, *built.values()],
                        "-warn:4", "-warnaserror")
        done = subprocess.run(["mono", "--debug", tests, STAND_IN, PROGRAM], cwd=out,
                              env={**os.environ, "WHOLEHAND_CONFIG": str(SOURCE / "config"),
                                   "WHOLEHAND_GAME_TABLE": str(TESTS / "game_table.toml")})
        self.assertEqual(done.returncode, 0)


class Manuals(unittest.TestCase):
    def test_csharp_pieces_compile_unchanged(self):
        out, engine, _, _, built = assemblies(self)
        pieces = [(manual.parent.name, piece) for manual in MANUALS
                  for piece in re.findall(r"^```csharp\n(.*?)^```", manual.read_text(encoding="utf-8"), re.S | re.M)]
        self.assertEqual(len(pieces), 4, "pieces of C# in the manuals")
        for i, (name, piece) in enumerate(pieces):
            source = out / f"piece_{i}_of_{name}.cs"
            source.write_text(piece, encoding="utf-8")
            compile_library(source.with_suffix(".dll"), [source], [engine, *built.values()], "-target:library")


BUILT = []


def assemblies(test):
    """(folder, engine, editor, nunit, by name): the package's assemblies and the stand-ins, compiled once."""
    if not BUILT:
        out = BUILD / "assemblies"
        shutil.rmtree(out, ignore_errors=True)
        out.mkdir()
        stub = TESTS / "unity/stub"
        engine, editor, nunit = (out / f"{name}.dll" for name in ("UnityEngine", "UnityEditor", "nunit.framework"))
        compile_library(engine, [stub / f"{name}.cs" for name in ("Maths", "Objects", "Headless")], [], "-target:library")
        compile_library(editor, [stub / "Editor.cs"], [engine], "-target:library")
        compile_library(nunit, [stub / "NUnit.cs"], [], "-target:library")
        built = compile_assemblies(test, out, {"engine": engine, "editor": editor, "nunit": nunit})
        test.assertEqual(sorted(built), ["Wholehand.Client", "Wholehand.Protocol", "Wholehand.Unity",
                                         "Wholehand.Unity.Editor", "Wholehand.Unity.Samples.Bar", "Wholehand.Unity.Tests"])
        BUILT.append((out, engine, editor, nunit, built))
    return BUILT[0]


def compile_assemblies(test, out, stubs):
    waiting = {}
    for file in (BUILD / NAME).rglob("*.asmdef"):
        definition = json.loads(file.read_text(encoding="utf-8"))
        definition["folder"] = file.parent
        waiting[definition["name"]] = definition
    folders = {definition["folder"] for definition in waiting.values()}
    built = {}
    while waiting:
        ready = [d for d in waiting.values() if all(r in built or r in STUBS for r in d["references"])]
        test.assertTrue(ready, f"{list(waiting)} wait for each other, or for what is not there")
        for definition in ready:
            name = definition["name"]
            built[name] = out / f"{name}.dll"
            compile_library(built[name], sources_of(definition["folder"], folders),
                            [*(built[r] for r in definition["references"] if r in built),
                             *stubs_of(definition, stubs)], "-target:library",
                            *(["-warn:0"] if name == "Wholehand.Protocol" else ["-warn:4", "-warnaserror"]))
            del waiting[name]
    return built


def stubs_of(definition, stubs):
    if not definition["noEngineReferences"]:
        yield stubs["engine"]
    if definition["includePlatforms"] == ["Editor"]:
        yield stubs["editor"]
    if "nunit.framework.dll" in definition["precompiledReferences"]:
        yield stubs["nunit"]


def sources_of(folder, folders):
    """A source belongs to the nearest .asmdef above it, as in Unity."""
    return [source for source in sorted(folder.rglob("*.cs"))
            if next(above for above in source.parents if above in folders) == folder]


if __name__ == "__main__":
    if len(sys.argv) < 4:
        sys.exit(__doc__)
    STAND_IN, PROGRAM, BUILD = sys.argv[1], sys.argv[2], pathlib.Path(sys.argv[3]).resolve()
    missing = [tool for tool in ("mcs", "mono", "flatc") if not shutil.which(tool)]
    if missing:
        print(f"skipped: {', '.join(missing)} not installed (mono-mcs, mono-runtime, flatbuffers-compiler)")
        sys.exit(77)
    BUILD.mkdir(parents=True, exist_ok=True)
    main(sys.argv[4:])
