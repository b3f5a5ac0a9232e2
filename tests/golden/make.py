#!/usr/bin/python3
"""Makes golden messages (docs/protocol.md, "Golden messages").

make.py --missing         examples of every payload and order that has none (TABLE, TABLE_full, TABLE_extreme), or that
                          has fields that are in no message (TABLE_full_2)
make.py FILE.json...      NAME.bin for a form in a file: {"about": ..., "form": ...}
make.py --special         valid and damaged messages of special.py that have no file yet
make.py --datagrams       datagrams of datagrams.py that have no file yet
make.py --program         messages of tests/golden/program_messages.cpp that have no file yet
make.py --show NAME       prints what a message says; with "about" it is a form for FILE.json

An existing .bin is never overwritten, because it represents released programs and clients. --build names the
folder of the build (build/release)."""
import argparse
import itertools
import json
import pathlib
import re
import sys
import tempfile

HERE = pathlib.Path(__file__).resolve().parent
sys.path.insert(0, str(HERE))
import datagrams  # noqa: E402
import forms  # noqa: E402
import run  # noqa: E402
import special  # noqa: E402

ROOT = HERE.parents[1]
MESSAGES, DATAGRAMS = run.GOLDEN / "messages", run.GOLDEN / "datagrams"


def snake(name):
    return re.sub(r"(?<!^)(?=[A-Z])", "_", name).lower()


def add_to_table(folder, name, entry):
    """One line an entry, sorted by name."""
    table = {**run.read_table(folder), name: entry}
    lines = (f"{json.dumps(key)}: {json.dumps(table[key], ensure_ascii=False)}" for key in sorted(table))
    (run.GOLDEN / folder / "table.json").write_text("{\n" + ",\n".join(lines) + "\n}\n", encoding="utf-8")


class Maker:
    def __init__(self, build):
        if not (build / "golden_judge").exists():
            sys.exit(f"{build}/golden_judge is missing; build it: ninja -C {build} golden_judge")
        self.judge = run.Judge(build)
        self.schema = self.judge.schema

    def judged(self, data):
        with tempfile.NamedTemporaryFile(suffix=".bin") as file:
            file.write(data)
            file.flush()
            return self.judge.messages([file.name])[0]

    def file(self, name):
        return MESSAGES / f"{self.schema.named(name)}.bin"

    def write(self, name, data, about, form=None):
        binary = self.file(name)
        name = binary.stem
        if binary.exists():
            sys.exit(f"{binary} exists and is not written again: give the new message another name")
        judged = self.judged(data)
        if form is not None and judged.get("form") != {"schema_version": self.schema.version, **form}:
            sys.exit(f"{name}: the form is not canonical, or was not read back; the judge reads\n"
                     f"{json.dumps(judged, indent=1, ensure_ascii=False)}")
        binary.write_bytes(data)
        version = {"version": self.schema.version} if "form" in judged else {}
        add_to_table("messages", name, {"about": about, **version, "digest": run.digest_of(judged)})
        print(f"{name}: {len(data)} bytes" + (f", the program refuses it: {judged['program']['refused']}"
                                              if "refused" in judged["program"] else ""))

    def examples(self, table):
        within = self.schema.payload_of(table)
        seen = []
        for variant, about in (("", f"{table} with every field absent"), ("_full", f"{table} with every field present"),
                               ("_extreme", f"{table} with the ends of every type")):
            form = within(self.schema.example(table, variant[1:]) if variant else {})
            if form not in seen:
                self.write(snake(table) + variant, self.schema.encode(form), about, form)
            seen.append(form)

    def missing(self):
        tables = [table for table in self.schema.members("Payload") + self.schema.members("Order") if table != "Command"]
        for table in tables:
            if not self.file(snake(table)).exists():
                self.examples(table)
        seen = set().union(*(self.schema.fields_in("Message", golden.form) for golden in run.read_goldens(self.judge)
                             if golden.form is not None))
        for table in tables:
            form = self.schema.payload_of(table)(self.schema.example(table, "full"))
            if self.schema.fields_in("Message", form) <= seen:
                continue
            seen |= self.schema.fields_in("Message", form)
            number = next(n for n in itertools.count(2) if not self.file(f"{snake(table)}_full_{n}").exists())
            self.write(f"{snake(table)}_full_{number}", self.schema.encode(form), f"{table} with every field of its day", form)

    def program(self):
        with tempfile.TemporaryDirectory() as folder:
            self.judge.say(folder)
            for file in sorted(pathlib.Path(folder).iterdir()):
                if not self.file(file.stem).exists():
                    self.write(file.stem, file.read_bytes(), "made by the program's own encoder")

    def datagrams(self):
        for name, about, sender, before, reason, data in datagrams.datagrams(self.schema):
            binary = DATAGRAMS / f"{name}.bin"
            if binary.exists():
                continue
            binary.write_bytes(data)
            golden = {"about": about, "from": sender, "key": f"{datagrams.KEY:016x}", "after": before, "ignored": reason}
            judged, = self.judge.datagrams([(golden["key"], [binary])])
            golden.update({key: judged[key] for key in ("header", "flaw") if key in judged})
            add_to_table("datagrams", name, golden)
            print(f"{name}: {len(data)} bytes" + (f", ignored: {reason}" if reason else ""))

    def show(self, name):
        print(json.dumps(self.judge.messages([MESSAGES / f"{name}.bin"])[0], indent=1, ensure_ascii=False))

    def from_form(self, path):
        golden = json.loads(path.read_text(encoding="utf-8"))
        form = golden["form"]
        form.pop("schema_version", None)
        self.write(path.stem, self.schema.encode(form, golden.get("explicit_defaults", False)), golden["about"], form)


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("what", nargs="*", metavar="FILE.json")
    parser.add_argument("--missing", action="store_true")
    parser.add_argument("--special", action="store_true")
    parser.add_argument("--datagrams", action="store_true")
    parser.add_argument("--program", action="store_true")
    parser.add_argument("--show", metavar="NAME")
    parser.add_argument("--build", type=pathlib.Path, default=ROOT / "build/release")
    arguments = parser.parse_args()
    maker = Maker(arguments.build)
    if arguments.show:
        maker.show(arguments.show)
    for what in arguments.what:
        maker.from_form(pathlib.Path(what))
    if arguments.missing:
        maker.missing()
    for name, about, data in special.messages(maker.schema) if arguments.special else []:
        if not maker.file(name).exists():
            maker.write(name, data, about)
    if arguments.datagrams:
        maker.datagrams()
    if arguments.program:
        maker.program()


if __name__ == "__main__":
    main()
