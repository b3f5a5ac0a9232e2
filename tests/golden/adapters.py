"""The clients, and how the runner makes each of them read and write messages. An adapter is a program in the client's
language; it gets a job and leaves an answer, both JSON (docs/protocol.md, "Golden messages")."""
import os
import shutil
import subprocess
import sys

import forms

SAID_BY_THE_PROGRAM = {"WorldState", "Scene", "Events", "Welcome", "Controls", "Reply", "GameBodies"}
ORDERS_OF_A_GAME = {"Arm", "Stop", "EmergencyStop", "LoadExercise", "SetParameter", "Aim", "Steer", "Action", "TakeControls",
                    "ReleaseControls"}
ORDERS_OF_A_PAGE = {"Heartbeat", "Rest", "SaveProfile", "LoadProfile", "SetHelp", "Answer", "HoldToMove"}
ORDERS_OF_BODIES = {"PrepareShapes", "Spawn", "Remove", "Teleport", "SetOwner", "BodyTargets"}
PATIENCE_S = 120


class Client:
    checks_bounds = False   # it detects every damaged message
    names_reasons = frozenset()  # reasons of the judge that it also reports
    has_datagrams = False
    reads = SAID_BY_THE_PROGRAM
    writes = ORDERS_OF_A_GAME

    def __init__(self, root, build):
        self.root, self.build, self.here = root, build, root / "tests/golden"

    def missing(self):
        """What must be installed first; empty: nothing."""
        return ""

    def prepare(self, work):
        """Builds the adapter."""

    def run(self, work, job, answer):
        """Makes the client do the job."""
        raise NotImplementedError

    def difference(self, expected, got):
        return forms.first_difference(expected, got)

    def call(self, command, **options):
        done = subprocess.run(command, text=True, capture_output=True, timeout=PATIENCE_S, **options)
        if done.returncode != 0:
            raise AssertionError(f"{command[0]} ended with {done.returncode}:\n{done.stdout[-2000:]}{done.stderr[-2000:]}")
        return done.stdout + done.stderr


class Python(Client):
    name = "python"
    names_reasons = {"identifier", "version", "payload"}
    reads = SAID_BY_THE_PROGRAM | {"Commissioning"}
    writes = ORDERS_OF_A_GAME | ORDERS_OF_BODIES | ORDERS_OF_A_PAGE

    def run(self, work, job, answer):
        self.call([sys.executable, "-B", self.here / "adapter.py", job, answer],
                  env={**os.environ, "PYTHONPATH": str(self.build / "python")})


class CSharp(Client):
    name = "csharp"
    has_datagrams = True
    writes = ORDERS_OF_A_GAME | ORDERS_OF_BODIES

    def missing(self):
        absent = [tool for tool in ("mcs", "mono", "flatc") if not shutil.which(tool)]
        return f"{', '.join(absent)} (mono-mcs, mono-runtime, flatbuffers-compiler)" if absent else ""

    def prepare(self, work):
        library = work / "library"
        self.call([self.root / "clients/csharp/build.sh", library])
        references = [f"-r:{library}/Wholehand.{name}.dll" for name in ("Protocol", "Client")]
        self.call(["mcs", "-langversion:7", "-debug", "-nologo", "-warn:4", "-warnaserror", *references,
                   f"-out:{library}/Golden.exe", *sorted((self.here / "csharp").glob("*.cs"))])

    def run(self, work, job, answer):
        self.call(["mono", "--debug", work / "library/Golden.exe", job, answer])


class TypeScript(Client):
    """The web pages' client."""
    name = "typescript"
    names_reasons = {"version"}
    reads = SAID_BY_THE_PROGRAM | {"Commissioning"}
    writes = ORDERS_OF_A_GAME | ORDERS_OF_A_PAGE

    def missing(self):
        if not shutil.which("node"):
            return "node (nodejs)"
        return "" if (self.root / "web/node_modules").exists() else "web/node_modules (npm ci in web/)"

    def prepare(self, work):
        web = self.root / "web"
        self.call(["npm", "run", "--silent", "protocol"], cwd=web)
        self.call([web / "node_modules/.bin/esbuild", web / "tests/golden.ts", "--bundle", "--platform=node",
                   f"--outfile={work}/golden.cjs", "--log-level=warning"])

    def run(self, work, job, answer):
        self.call(["node", work / "golden.cjs", job, answer])


def is_zero(value):
    """The addon's value for an absent field; for an orientation, the zero rotation."""
    if isinstance(value, dict):
        return all(is_zero(number) or (name == "w" and number == "3f800000") for name, number in value.items())
    return value in (0, False, "", [], "0" * 8, "0" * 16)


class Godot(Client):
    """The addon keeps only some fields; these are compared: every variable of its own objects."""
    name = "godot"
    checks_bounds = True
    writes = ORDERS_OF_A_GAME | ORDERS_OF_BODIES

    def missing(self):
        return "" if shutil.which("godot3-server") else "godot3-server"

    def prepare(self, work):
        project = work / "project"
        shutil.rmtree(project, ignore_errors=True)
        self.call([sys.executable, "-B", self.root / "scripts/godot_addon.py", "make", project])
        shutil.copyfile(self.root / "tests/clients/godot/project.godot", project / "project.godot")
        for script in (self.here / "godot").glob("*.gd"):
            shutil.copyfile(script, project / script.name)
        (work / "home/godot/app_userdata/Tests of the Wholehand addon/logs").mkdir(parents=True, exist_ok=True)

    def run(self, work, job, answer):
        home = work / "home"
        said = self.call(["godot3-server", "--path", work / "project", "-s", "res://golden.gd"], env={
            **os.environ, "WHOLEHAND_JOB": str(job), "WHOLEHAND_ANSWER": str(answer), "LANG": "en_US.UTF-8", "LC_ALL": "en_US.UTF-8",
            **{name: str(home) for name in ("HOME", "XDG_DATA_HOME", "XDG_CONFIG_HOME", "XDG_CACHE_HOME")}})
        errors = [line for line in said.splitlines() if "ERROR" in line]
        if errors:
            raise AssertionError(f"the addon's scripts fail: {errors[:5]}")

    def difference(self, expected, got):
        """Where the returned values differ; fields that it does not return are not compared."""
        if isinstance(got, dict) and isinstance(expected, dict):
            for name, value in got.items():
                if name not in expected and not is_zero(value):
                    return f"{name} is {value!r}, expected: absent"
                found = self.difference(expected[name], value) if name in expected else None
                if found:
                    return f"{name}.{found}"
            return None
        if isinstance(got, list) and isinstance(expected, list) and len(got) == len(expected):
            return next(filter(None, map(self.difference, expected, got)), None)
        return None if got == expected else f"is {got!r}, expected {expected!r}"


CLIENTS = {client.name: client for client in (Python, CSharp, TypeScript, Godot)}
