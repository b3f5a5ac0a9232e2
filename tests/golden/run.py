"""Tests every client with the golden messages and datagrams of protocol/golden: docs/protocol.md, "Golden messages".

run.py BUILD CLIENT       CLIENT: program, python, csharp, typescript, godot. Exit code 77: its tools are not installed."""
import base64
import hashlib
import json
import os
import pathlib
import resource
import subprocess
import sys
import time
from random import Random

HERE = pathlib.Path(__file__).resolve().parent
sys.path.insert(0, str(HERE))
import adapters  # noqa: E402
import forms  # noqa: E402

ROOT = HERE.parents[1]
GOLDEN = ROOT / "protocol/golden"
FEWEST_MESSAGES, FEWEST_DATAGRAMS = 60, 30
MUTATED, MUTATED_ROUNDS = (4000, 25) if os.environ.get("WHOLEHAND_FULL") == "1" else (400, 1)
LONGEST_S = 3.0    # processor time for one message (Godot: wall time); a tenth of a millisecond is usual
LARGEST_MB = 1024  # memory of a client with 4,000 messages of up to 26 kB
MAKE = "/usr/bin/python3 tests/golden/make.py"


class Golden:
    """A golden file's bytes, its entry in the table, and what the judge reads in it (read_goldens)."""

    def __init__(self, folder, name, entry):
        self.name, self.path, self.entry = name, folder / f"{name}.bin", entry
        self.bytes = self.path.read_bytes()
        self.judged = {}

    @property
    def form(self):
        return self.judged.get("form")

    @property
    def flaw(self):
        return self.judged.get("refused")

    @property
    def payload(self):
        (kind, form), = self.form["payload"].items()
        return kind, form

    @property
    def is_command(self):
        """Whether a client sends it."""
        return self.form is not None and self.payload[0] == "Command"

    @property
    def has_order(self):
        return self.is_command and "order" in self.payload[1]


def digest_of(judged):
    """Digest of what a message says. The program's own reading belongs to it where the program receives the message."""
    said = {key: judged[key] for key in ("form", "refused") if key in judged}
    if "refused" in said or "Command" in said["form"]["payload"]:
        said["program"] = judged["program"]
    return hashlib.sha256(json.dumps(said, sort_keys=True).encode()).hexdigest()[:16]


def read_table(folder):
    return json.loads((GOLDEN / folder / "table.json").read_text(encoding="utf-8"))


def goldens(folder):
    table, there = read_table(folder), {path.stem for path in (GOLDEN / folder).glob("*.bin")}
    alone = there ^ set(table)
    if alone:
        raise AssertionError(f"protocol/golden/{folder}: {', '.join(sorted(alone))}: a .bin and its line of table.json belong together")
    return [Golden(GOLDEN / folder, name, table[name]) for name in sorted(table)]


def read_goldens(judge):
    """The golden messages with their forms."""
    all_goldens = goldens("messages")
    for golden, judged in zip(all_goldens, judge.messages([g.path for g in all_goldens])):
        golden.judged = judged
    return all_goldens


class Failures:
    def __init__(self):
        self.all = []

    def check(self, condition, what):
        if not condition:
            self.all.append(what)
        return condition

    def equal(self, expected, got, what):
        difference = forms.first_difference(expected, got)
        return self.check(difference is None, f"{what}: {difference}")


class Judge:
    def __init__(self, build):
        self.program, self.compiled = build / "golden_judge", build / "tests/golden/wholehand.bfbs"
        self.schema = forms.Schema(self.program, self.compiled)

    def _ask(self, arguments, lines):
        done = subprocess.run([self.program, *arguments], input="".join(f"{line}\n" for line in lines), text=True,
                              capture_output=True, errors="backslashreplace")
        if done.returncode != 0:
            raise AssertionError(f"golden_judge {arguments[0]} ended with {done.returncode}: {done.stderr}")
        return [json.loads(line) for line in done.stdout.splitlines()]

    def messages(self, paths):
        return self._ask(["messages", self.compiled], paths)

    def datagrams(self, conversations):
        return self._ask(["datagrams"], [" ".join([key, *map(str, paths)]) for key, paths in conversations])

    def say(self, folder):
        self._ask(["say", folder], [])


# ---- the files, checked by the judge and the program ----

def of_another_version(golden, schema):
    return golden.entry.get("version", schema.version) != schema.version


def check_messages(judge, all_goldens, failures):
    for golden, judged in zip(all_goldens, judge.messages([g.path for g in all_goldens])):
        if of_another_version(golden, judge.schema):
            # After a rise of the version, older messages must be refused by name and never misread.
            failures.equal("version", judged.get("refused"), f"{golden.name}, of an older schema")
            continue
        failures.check(digest_of(judged) == golden.entry["digest"], f"{golden.name}: what is out there is read otherwise "
                       "today; undo the change of the schema, or raise schema_version. Today it says: "
                       f"{json.dumps(judged, ensure_ascii=False)[:2000]}")
        if "form" in judged and "Command" not in judged["form"]["payload"]:
            failures.check("refused" in judged["program"], f"{golden.name}: the program takes it for an order")


def check_coverage(schema, all_goldens, failures):
    seen, tables = set(), set()
    for golden in all_goldens:
        if golden.form is not None and not of_another_version(golden, schema):
            seen |= schema.fields_in("Message", golden.form)
            kind, form = golden.payload
            tables |= {kind, *form.get("order", {})}
    for table in schema.members("Payload") + schema.members("Order"):
        failures.check(table in tables, f"{table} has no golden message; make some: {MAKE} --missing")
    for name, described in schema.objects.items():
        for field in described["fields"]:
            failures.check(field["kind"] == "utype" or (name, field["name"]) in seen,
                           f"{name}.{field['name']} is in no golden message; make one: {MAKE} --missing")


def check_program_says(judge, all_goldens, work, failures):
    """The program's encoders must write what they wrote when the files were made, and may write more."""
    folder = work / "said"
    folder.mkdir(parents=True, exist_ok=True)
    judge.say(folder)
    paths = sorted(folder.glob("*.bin"))
    by_name = {golden.name: golden for golden in all_goldens}
    for path, judged in zip(paths, judge.messages(paths)):
        name = judge.schema.named(path.stem)
        if failures.check(name in by_name, f"{name} has no file; make it: {MAKE} --program"):
            difference = forms.first_difference(by_name[name].form, judged.get("form"), part=True)
            failures.check(difference is None, f"{path.stem}: the program says something else: {difference}")
    return len(paths)


def check_datagrams(judge, all_datagrams, failures):
    judged = judge.datagrams([(d.entry["key"], conversation_of(d)) for d in all_datagrams])
    for datagram, got in zip(all_datagrams, judged):
        check_datagram(datagram, got, failures, "the program")
        if datagram.entry["from"] == "game":
            failures.equal(datagram.entry["ignored"], got["ignored"], f"{datagram.name}: why the program ignores it")
    failures.check(len(all_datagrams) >= FEWEST_DATAGRAMS,
                   f"{len(all_datagrams)} datagrams, at least {FEWEST_DATAGRAMS} are kept")


def conversation_of(datagram):
    return [datagram.path.with_name(f"{name}.bin") for name in [*datagram.entry["after"], datagram.name]]


def check_datagram(datagram, got, failures, who):
    """Checks its header or flaw, and that it is written byte for byte the same."""
    for what in ("flaw", "header"):
        failures.equal(datagram.entry.get(what), got.get(what), f"{who} reads {datagram.name}: {what}")
    if "header" in got:
        failures.check(got["written_the_same"], f"{who} writes {datagram.name} otherwise")


def run_program(judge, all_goldens, all_datagrams, work, failures):
    check_messages(judge, all_goldens, failures)
    check_coverage(judge.schema, all_goldens, failures)
    said = check_program_says(judge, all_goldens, work, failures)
    failures.check(len(all_goldens) >= FEWEST_MESSAGES, f"{len(all_goldens)} messages, at least {FEWEST_MESSAGES} are kept")
    check_datagrams(judge, all_datagrams, failures)
    return f"{len(all_goldens)} messages read, {said} written, {len(all_datagrams)} datagrams"


# ---- clients ----

def expected_of(client, golden, schema):
    """What the client must read from a message."""
    if of_another_version(golden, schema):
        return {"refused": "version"}
    if golden.flaw:
        return {"refused": golden.flaw}
    return {"payload": golden.form["payload"]}


def check_read(client, golden, got, schema, failures):
    what = f"{client.name} reads {golden.name}"
    expected = expected_of(client, golden, schema)
    if "refused" in expected:
        if golden.flaw == "damaged" and not client.checks_bounds:
            return "survived"  # FlatBuffers has no verifier in this language: the client only had to end
        if failures.check("refused" in got, f"{what}: it is taken for a message, expected: refused ({expected['refused']})"):
            if expected["refused"] in client.names_reasons:
                failures.equal(expected["refused"], got["refused"], f"{what}: reason")
        return "refused"
    kind, _ = golden.payload
    if "payload" not in got and kind not in client.reads:
        return "unread"
    difference = client.difference(expected.get("payload"), got.get("payload"))
    failures.check("payload" in got and difference is None, f"{what}: {difference or got}")
    return "read"


def check_written(client, golden, written, judged, failures):
    _, command = golden.payload
    (order, _), = command["order"].items()
    if written is None:
        # A client may decline an order that the program would refuse.
        failures.check(order not in client.writes or "refused" in golden.judged["program"], f"{client.name} has to write {order}")
        return False
    difference = forms.first_difference(golden.form, judged.get("form"))
    failures.check(difference is None, f"{client.name} writes {golden.name}: {difference}")
    failures.equal(golden.judged["program"], judged["program"], f"{client.name} writes {golden.name}: the program's own reading")
    return True


def check_datagrams_of(client, heard, answer, failures):
    for datagram in heard:
        got = answer.get(datagram.name)
        if failures.check(got is not None, f"{client.name} says nothing of {datagram.name}"):
            check_datagram(datagram, got, failures, client.name)
            reason = datagram.entry["ignored"]
            failures.equal(reason if reason in ("", "stale") else "ignored", got["taken"], f"{client.name} ignores {datagram.name}")


NUMBERS = [0, 1, 0xff, 0xffff, 0x10000, 0xffffff, 0x7fffffff, 0x80000000, 0xffffffff]


def flip_bits(data, random, _other):
    for _ in range(random.randint(1, 8)):
        data[random.randrange(len(data))] ^= 1 << random.randrange(8)


def change_bytes(data, random, _other):
    for _ in range(random.randint(1, 3)):
        data[random.randrange(len(data))] = random.randrange(256)


def overwrite_number(data, random, _other):
    at = 4 * random.randrange(len(data) // 4)
    data[at:at + 4] = random.choice(NUMBERS).to_bytes(4, "little")


def cut(data, random, _other):
    del data[random.randrange(len(data)):]


def change_length(data, random, _other):
    """Changes one number that can be a length or an offset within the message, slightly or strongly."""
    places = [at for at in range(0, len(data) - 3, 4) if 0 < int.from_bytes(data[at:at + 4], "little") < len(data)]
    at = random.choice(places)
    number = int.from_bytes(data[at:at + 4], "little")
    number = random.choice([number - 1, number + 1, number - 4, number + 4, 2 * number, len(data), len(data) - at,
                            number << 8, number << 24, random.randrange(1 << 32)])
    data[at:at + 4] = (number & 0xffffffff).to_bytes(4, "little")


def splice(data, random, other):
    """The head of one message and the tail of another."""
    data[random.randrange(len(data)):] = other[random.randrange(len(other)):]


def move(data, random, _other):
    """Removes a section, or copies it to another place."""
    a, b = sorted(random.randrange(len(data)) for _ in range(2))
    stretch = data[a:b]
    if random.random() < 0.5:
        del data[a:b]
    at = random.randrange(len(data) + 1)
    data[at:at] = stretch


MUTATIONS = [flip_bits, change_bytes, overwrite_number, cut, change_length, splice, move]


def mutated(all_goldens, count, seed):
    """Damaged messages of the program, as (name, bytes)."""
    random = Random(seed)
    sound = [g.bytes for g in all_goldens if g.form is not None and not g.is_command]
    for i in range(count):
        data = bytearray(random.choice(sound))
        mutation = random.choice(MUTATIONS)
        mutation(data, random, random.choice(sound))
        yield f"{mutation.__name__}_{seed}_{i}", bytes(data)


def survive(client, schema, all_goldens, work, failures):
    """Reading damaged messages must end: no exception escapes, nothing hangs and memory is bounded."""
    first = int(os.environ.get("WHOLEHAND_SEED", "1"))
    refused, longest_s = 0, 0.0
    for seed in range(first, first + MUTATED_ROUNDS):
        damaged = dict(mutated(all_goldens, MUTATED, seed))
        answer = ask(client, {"layout": schema.layout, "write": [], "datagrams": [], "read": [
            {"name": name, "bytes": base64.b64encode(data).decode()} for name, data in damaged.items()]}, work)
        failures.equal(set(damaged), set(answer["read"]), f"{client.name}: mutated messages of seed {seed}")
        for name, read in answer["read"].items():
            check_survived(client, name, read, damaged.get(name, b""), work, failures)
            refused += "refused" in (read or {})
        longest_s = max(longest_s, answer["longest_s"])
    largest_mb = resource.getrusage(resource.RUSAGE_CHILDREN).ru_maxrss / 1024
    failures.check(longest_s <= LONGEST_S, f"{client.name} reads {longest_s:.1f} s at one message, at most {LONGEST_S} s are allowed")
    failures.check(largest_mb <= LARGEST_MB, f"{client.name} takes {largest_mb:.0f} MB, at most {LARGEST_MB} MB are allowed")
    print(f"figure: {client.name}: {MUTATED * MUTATED_ROUNDS} mutated messages, {refused} refused; "
          f"at most {1e3 * longest_s:.1f} ms, {largest_mb:.0f} MB")
    return MUTATED * MUTATED_ROUNDS


def check_survived(client, name, read, data, work, failures):
    """Checks that reading ended with a value or the client's own error; otherwise keeps the bytes."""
    if not failures.check(isinstance(read, dict) and ("payload" in read or "unread" in read or "refused" in read),
                          f"{client.name} reads {name}: {read}; its bytes: {work}/{name}.bin"):
        (work / f"{name}.bin").write_bytes(data)


def ask(client, job, work):
    (work / "job.json").write_text(json.dumps(job, ensure_ascii=False), encoding="utf-8")
    (work / "answer.json").unlink(missing_ok=True)
    client.run(work, work / "job.json", work / "answer.json")
    # A text of a damaged message may be invalid UTF-8 and contain any character.
    return json.loads((work / "answer.json").read_text(encoding="utf-8", errors="replace"), strict=False)


def run_client(client, judge, all_goldens, all_datagrams, work, failures):
    said = [d for d in all_datagrams if d.entry["from"] == "program"] if client.has_datagrams else []
    commands = [g for g in all_goldens if g.has_order and not of_another_version(g, judge.schema)]
    heard = [g for g in all_goldens if not g.is_command]
    job = {"layout": judge.schema.layout,
           "read": [{"name": g.name, "bytes": base64.b64encode(g.bytes).decode()} for g in heard],
           "write": [{"name": g.name, "id": g.payload[1].get("id", 0), "order": next(iter(g.payload[1]["order"])),
                      "fields": next(iter(g.payload[1]["order"].values()))} for g in commands],
           "datagrams": [{"name": d.name, "key": d.entry["key"], "conversation": [
               base64.b64encode(path.read_bytes()).decode() for path in conversation_of(d)]} for d in said]}
    client.prepare(work)
    answer = ask(client, job, work)
    counts = {}
    for golden in heard:
        if failures.check(golden.name in answer["read"], f"{client.name} says nothing of {golden.name}"):
            outcome = check_read(client, golden, answer["read"][golden.name], judge.schema, failures)
            counts[outcome] = counts.get(outcome, 0) + 1
    paths = {}
    for name, data in answer["write"].items():
        if data is not None:
            paths[name] = work / f"{name}.bin"
            paths[name].write_bytes(base64.b64decode(data))
    judged = dict(zip(paths, judge.messages(paths.values())))
    counts["written"] = sum(check_written(client, golden, answer["write"].get(golden.name), judged.get(golden.name, {}), failures)
                            for golden in commands)
    check_datagrams_of(client, said, answer.get("datagrams", {}), failures)
    counts["datagrams"] = len(said)
    counts["mutated"] = survive(client, judge.schema, all_goldens, work, failures)
    return ", ".join(f"{count} {outcome}" for outcome, count in counts.items())


def main():
    if len(sys.argv) != 3 or sys.argv[2] not in ("program", *adapters.CLIENTS):
        sys.exit(__doc__)
    build, name = pathlib.Path(sys.argv[1]).resolve(), sys.argv[2]
    client = adapters.CLIENTS[name](ROOT, build) if name != "program" else None
    if client and client.missing():
        print(f"skipped: {client.missing()}")
        sys.exit(77)
    began = time.monotonic()
    failures, judge, work = Failures(), Judge(build), build / "golden" / name
    work.mkdir(parents=True, exist_ok=True)
    files = read_goldens(judge), goldens("datagrams")
    done = run_client(client, judge, *files, work, failures) if client else run_program(judge, *files, work, failures)
    for failure in failures.all[:40]:
        print(f"FAILED: {failure}")
    print(f"{name}: {done}; {len(failures.all)} failures, {time.monotonic() - began:.1f} s")
    sys.exit(1 if failures.all else 0)


if __name__ == "__main__":
    main()
