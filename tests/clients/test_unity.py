"""The Unity package without Unity: made and checked; compiled by mono, assembly by assembly as its .asmdef files say,
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
sys.path.insert(0, str(SCRIPT.parent))
import unity_package  # noqa: E402

NAME = "org.wholehand.client"
STUBS = {"UnityEngine.TestRunner", "UnityEditor.TestRunner"}  # in the stub of NUnit


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

    def setUp(self):
        self.package = BUILD / NAME
        self.folder = pathlib.Path(tempfile.mkdtemp(prefix="wholehand-test-"))
        self.addCleanup(shutil.rmtree, self.folder)
        self.copy = self.folder / NAME
        shutil.copytree(self.package, self.copy)

    def expect_refused(self, *texts):
        faults = unity_package.faults_of(self.copy, unity_package.project_version())
        self.assertEqual(len(faults), 1, faults)
        for text in texts:
            self.assertIn(text, faults[0])

    def test_the_package_is_sound(self):
        for package in (self.package, SOURCE / "clients/unity" / NAME):
            checked = package_script("check", package)
            self.assertEqual(checked.returncode, 0, checked.stderr)

    def test_the_archive_is_what_upm_takes(self):
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

    def test_made_twice_it_has_the_same_bytes(self):
        made = package_script("make", self.folder / "again")
        self.assertEqual(pathlib.Path(made.stdout.strip()).read_bytes(), ARCHIVE.read_bytes())

    def test_a_missing_meta_is_refused(self):
        (self.copy / "Runtime/WholehandHand.cs.meta").unlink()
        checked = package_script("check", self.copy)
        self.assertEqual(checked.returncode, 1)
        self.assertEqual(len(checked.stderr.splitlines()), 1, checked.stderr)
        self.expect_refused("Runtime/WholehandHand.cs", "WholehandHand.cs.meta is missing", "unity_package.py meta")

    def test_a_meta_of_a_folder_counts_too(self):
        (self.copy / "Runtime/Protocol.meta").unlink()
        self.expect_refused("Runtime/Protocol: its file Protocol.meta is missing")

    def test_a_meta_without_its_file_is_refused(self):
        (self.copy / "Editor/WholehandMenu.cs").unlink()
        self.expect_refused("WholehandMenu.cs.meta: there is no WholehandMenu.cs")

    def test_another_version_than_the_projects_is_refused(self):
        manifest = self.copy / "package.json"
        manifest.write_text(manifest.read_text().replace('"version": "0', '"version": "7', 1))
        self.expect_refused("package.json: version is '7", "CMakeLists.txt")

    def test_a_guid_that_is_used_twice_is_refused(self):
        one, other = self.copy / "Runtime/WholehandBody.cs.meta", self.copy / "Runtime/WholehandWorld.cs.meta"
        shutil.copyfile(one, other)
        self.expect_refused("WholehandWorld.cs.meta: guid", "is that of Runtime/WholehandBody.cs, too")

    def test_a_guid_that_changed_is_refused(self):
        meta = self.copy / "Runtime/WholehandBody.cs.meta"
        meta.write_text(re.sub("guid: .*", "guid: " + "0" * 32, meta.read_text()))
        self.expect_refused("WholehandBody.cs.meta: guid 0000", "is not the one of this path")

    def test_a_guid_that_is_none_is_refused(self):
        meta = self.copy / "Runtime/WholehandBody.cs.meta"
        meta.write_text(re.sub("guid: .*", "guid: 12", meta.read_text()))
        self.expect_refused("guid is '12', not 32 hexadecimal digits")

    def test_a_manifest_that_is_no_json_is_refused(self):
        (self.copy / "package.json").write_text("{")
        self.expect_refused("package.json", "a package needs a manifest in JSON")


class Assemblies(unittest.TestCase):
    """Each .asmdef as an assembly of its own, with what it references and nothing else."""

    def test_they_compile_and_run(self):
        out = BUILD / "assemblies"
        shutil.rmtree(out, ignore_errors=True)
        out.mkdir()
        stub = TESTS / "unity/stub"
        engine, editor, nunit = (out / f"{name}.dll" for name in ("UnityEngine", "UnityEditor", "nunit.framework"))
        compile_library(engine, [stub / f"{name}.cs" for name in ("Maths", "Objects", "Headless")], [], "-target:library")
        compile_library(editor, [stub / "Editor.cs"], [engine], "-target:library")
        compile_library(nunit, [stub / "NUnit.cs"], [], "-target:library")
        built = self.compile_assemblies(out, {"engine": engine, "editor": editor, "nunit": nunit})
        self.assertEqual(sorted(built), ["Wholehand.Client", "Wholehand.Protocol", "Wholehand.Unity",
                                         "Wholehand.Unity.Editor", "Wholehand.Unity.Samples.Bar", "Wholehand.Unity.Tests"])
        tests = out / "HeadlessTests.exe"
        shared = [TESTS / "csharp/Runner.cs", TESTS / "csharp/RealProgram.cs", TESTS / "csharp/StandIn.cs"]
        compile_library(tests, [*sorted((TESTS / "unity").glob("*.cs")), *shared], [engine, editor, nunit, *built.values()],
                        "-warn:4", "-warnaserror")
        done = subprocess.run(["mono", "--debug", tests, STAND_IN, PROGRAM], cwd=out,
                              env={**os.environ, "WHOLEHAND_CONFIG": str(SOURCE / "config"),
                                   "WHOLEHAND_GAME_TABLE": str(TESTS / "game_table.toml")})
        self.assertEqual(done.returncode, 0)

    def compile_assemblies(self, out, stubs):
        waiting = {}
        for file in (BUILD / NAME).rglob("*.asmdef"):
            definition = json.loads(file.read_text(encoding="utf-8"))
            definition["folder"] = file.parent
            waiting[definition["name"]] = definition
        folders = {definition["folder"] for definition in waiting.values()}
        built = {}
        while waiting:
            ready = [d for d in waiting.values() if all(r in built or r in STUBS for r in d["references"])]
            self.assertTrue(ready, f"{list(waiting)} wait for each other, or for what is not there")
            for definition in ready:
                name = definition["name"]
                built[name] = out / f"{name}.dll"
                compile_library(built[name], self.sources_of(definition["folder"], folders),
                                [*(built[r] for r in definition["references"] if r in built),
                                 *self.stubs_of(definition, stubs)], "-target:library",
                                *(["-warn:0"] if name == "Wholehand.Protocol" else ["-warn:4", "-warnaserror"]))
                del waiting[name]
        return built

    @staticmethod
    def stubs_of(definition, stubs):
        if not definition["noEngineReferences"]:
            yield stubs["engine"]
        if definition["includePlatforms"] == ["Editor"]:
            yield stubs["editor"]
        if "nunit.framework.dll" in definition["precompiledReferences"]:
            yield stubs["nunit"]

    @staticmethod
    def sources_of(folder, folders):
        """As Unity: a source belongs to the nearest .asmdef above it."""
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
    unittest.main(argv=[sys.argv[0], *sys.argv[4:]])
