"""The clients, and how the runner has each read and write messages. An adapter is a program in the client's language; it
gets a job and leaves an answer, both JSON (docs/protocol.md, "Golden messages")."""
import os
import shutil
import subprocess
import sys

import forms

SAID_BY_THE_PROGRAM = {"WorldState", "Scene", "Events", "Welcome", "Controls", "Reply"}
ORDERS_OF_A_GAME = {"Arm", "Stop", "EmergencyStop", "LoadExercise", "SetParameter", "Aim", "Steer", "Action", "TakeControls",
                    "ReleaseControls"}
PATIENCE_S = 120


class Client:
    checks_bounds = False   # it finds every damaged message
    names_reasons = True    # it says why it refuses a message
    has_datagrams = False
    reads = SAID_BY_THE_PROGRAM
    writes = ORDERS_OF_A_GAME

    def __init__(self, root, build):
        self.root, self.build, self.here = root, build, root / "tests/golden"

    def missing(self):
        """What is to be installed first; empty: nothing."""
        return ""

    def difference(self, expected, got):
        return forms.first_difference(expected, got)

    def call(self, command, **options):
        done = subprocess.run(command, text=True, capture_output=True, timeout=PATIENCE_S, **options)
        if done.returncode != 0:
            raise AssertionError(f"{command[0]} ended with {done.returncode}:\n{done.stdout[-2000:]}{done.stderr[-2000:]}")
        return done.stdout


class Python(Client):
    name = "python"

    def run(self, work, job, answer):
        self.call([sys.executable, "-B", self.here / "adapter.py", job, answer],
                  env={**os.environ, "PYTHONPATH": str(self.build / "python")})


class CSharp(Client):
    name = "csharp"
    names_reasons = False
    has_datagrams = True

    def missing(self):
        absent = [tool for tool in ("mcs", "mono", "flatc") if not shutil.which(tool)]
        return f"{', '.join(absent)} (mono-mcs, mono-runtime, flatbuffers-compiler)" if absent else ""

    def run(self, work, job, answer):
        library = work / "library"
        self.call([self.root / "clients/csharp/build.sh", library])
        references = [f"-r:{library}/Wholehand.{name}.dll" for name in ("Protocol", "Client")]
        self.call(["mcs", "-langversion:7", "-debug", "-nologo", "-warn:4", "-warnaserror", *references,
                   f"-out:{library}/Golden.exe", *sorted((self.here / "csharp").glob("*.cs"))])
        self.call(["mono", "--debug", library / "Golden.exe", job, answer])


CLIENTS = {client.name: client for client in (Python, CSharp)}
