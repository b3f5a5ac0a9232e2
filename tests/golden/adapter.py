"""The Python client reads and writes golden messages: adapter.py JOB.json ANSWER.json."""
import asyncio
import base64
import json
import pathlib
import struct
import sys
import time

import numpy
from wholehand import bodies, connection, messages

FORMATS = {"i64": ">q", "u64": ">Q", "f32": ">f", "f64": ">d"}
job = json.loads(pathlib.Path(sys.argv[1]).read_text(encoding="utf-8"))
objects = job["layout"]["objects"]


def scalar(kind, value):
    if kind in FORMATS:
        return struct.pack(FORMATS[kind], value).hex()
    return bool(value) if kind == "bool" else int(value)


def element(kind, field, value):
    """A value of the client in the canonical form."""
    if kind == "table":
        return table(value)
    if kind == "string":
        return value
    return struct_of(field["of"], value) if kind == "struct" else scalar(kind, value)


def struct_of(name, record):
    if name in ("Vec3", "QuatXyzw"):  # the client returns them as arrays
        return {field["name"]: scalar("f32", number) for field, number in zip(objects[name]["fields"], record)}
    member = (lambda key: getattr(record, key)) if isinstance(record, messages.Table) else record.__getitem__
    return {field["name"]: element(field["kind"], field, member(field["name"])) for field in objects[name]["fields"]}


def table(read):
    form = {}
    for field in objects[read.kind]["fields"]:
        name, kind = field["name"], field["kind"]
        if kind in ("utype", "union"):
            continue  # a field of commands, which this client only writes
        value = getattr(read, name)
        if value is None:
            continue
        if kind == "vector":
            value = [element(field["element"], field, item) for item in value]
        else:
            value = element(kind, field, value)
        if kind in ("table", "struct") or value not in ("", [], field.get("default")):
            form[name] = value
    return form


def reason_of(error):
    """The kind of flaw that the client's error message reports."""
    for words, reason in (("schema_version", "version"), ("payload", "payload"), ("not a message of Wholehand's", "identifier")):
        if str(error).startswith(words):
            return reason
    return "damaged"


def read(data):
    """Reads a message as the connection's listener does, then returns it field by field."""
    try:
        message = messages.decode(data)
        connection.Connection(None)._hear(message)
        return {"payload": {message.kind: table(message)}}
    except messages.MessageError as error:
        return {"refused": reason_of(error)}
    except Exception as error:  # noqa: BLE001: the runner counts escaped exceptions
        return {"escaped": repr(error)}


longest_s = 0.0


def timed_read(data):
    global longest_s
    began = time.process_time()
    got = read(data)
    longest_s = max(longest_s, time.process_time() - began)
    return got


def given(field, value):
    """A value of the canonical form in the type that this client takes."""
    kind = field["element"] if field["kind"] == "vector" else field["kind"]
    def of(item):
        return struct.unpack(FORMATS[kind], bytes.fromhex(item))[0] if kind in FORMATS else item
    return numpy.array([of(item) for item in value], "<f4") if field["kind"] == "vector" else of(value)


def number(bits):
    return struct.unpack(">f", bytes.fromhex(bits))[0]


def numbers(struct_form):
    return [number(bits) for bits in (struct_form or {}).values()]


def place(pose):
    return {"position_m": numbers(pose["position_m"]), "orientation_xyzw": numbers(pose["orientation_xyzw"])}


def piece(form):
    return bodies.Shape(form.get("type", 0), numbers(form["half_extents_m"]), number(form["radius_m"]), number(form["length_m"]),
                        [numbers(point) for point in form.get("points_m", [])], form.get("triangles", []), **place(form["in_body"]))


def spawned(form):
    ready = {name: form[name] for name in ("slot", "generation", "shape_set", "owner", "refuse_overlap") if name in form}
    return bodies.Body(**ready, **place(form["pose"]), mass_kg=number(form["mass_kg"]), friction=number(form["friction"]),
                       velocity_m_s=numbers(form["velocity_m_s"]))


def named(form):
    return form["slot"], form["generation"]


def at(form):
    return (*named(form), *place(form["pose"]).values())


class Socket:
    """Stores what a connection sends."""
    kept = None

    async def send(self, data):
        self.kept = data


# Orders to bodies: written with the methods that a game calls; their arguments differ from those of the schema.
BODIES = {"Spawn": ("spawn", spawned), "Remove": ("remove", named), "Teleport": ("teleport", at),
          "SetOwner": ("set_owner", lambda form: (*named(form), form["owner"])), "BodyTargets": ("body_targets", at)}


async def order_of_bodies(entry):
    program = connection.Connection(Socket())
    program._number = entry["id"] - 1
    fields = entry["fields"]
    if entry["order"] == "PrepareShapes":
        asked = program.prepare_shapes(fields.get("set", 0), *map(piece, fields.get("pieces", [])))
    else:
        method, item = BODIES[entry["order"]]
        asked = getattr(program, method)(*map(item, fields.get("bodies", [])))
    asking = asyncio.ensure_future(asked)
    while program._socket.kept is None and not asking.done():
        await asyncio.sleep(0)
    asking.cancel()  # now it waits for the answer
    return program._socket.kept


OF_THE_RECORDS = {"OpenVisit", "CloseVisit"}  # no client for games sends them


def write(entry):
    if entry["order"] in (*BODIES, "PrepareShapes"):
        return asyncio.run(order_of_bodies(entry))
    fields = {field["name"]: field for field in objects[entry["order"]]["fields"]}
    return messages.encode(entry["id"], entry["order"],
                           **{name: given(fields[name], value) for name, value in entry["fields"].items()})


answer = {"read": {entry["name"]: timed_read(base64.b64decode(entry["bytes"])) for entry in job["read"]},
          "write": {entry["name"]: base64.b64encode(write(entry)).decode() for entry in job["write"]
                    if entry["order"] not in OF_THE_RECORDS},
          "longest_s": longest_s}
pathlib.Path(sys.argv[2]).write_text(json.dumps(answer), encoding="utf-8")
