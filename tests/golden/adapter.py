"""The Python client reads and writes golden messages: adapter.py JOB.json ANSWER.json."""
import base64
import json
import pathlib
import struct
import sys
import time

import numpy
from wholehand import connection, messages

FORMATS = {"i64": ">q", "u64": ">Q", "f32": ">f", "f64": ">d"}
job = json.loads(pathlib.Path(sys.argv[1]).read_text(encoding="utf-8"))
objects = job["layout"]["objects"]


def scalar(kind, value):
    if kind in FORMATS:
        return struct.pack(FORMATS[kind], value).hex()
    return bool(value) if kind == "bool" else int(value)


def element(kind, field, value):
    """A value of the client's as the form has it."""
    if kind == "table":
        return table(value)
    if kind == "string":
        return value
    return struct_of(field["of"], value) if kind == "struct" else scalar(kind, value)


def struct_of(name, record):
    if name in ("Vec3", "QuatXyzw"):  # the client gives them as arrays
        return {field["name"]: scalar("f32", number) for field, number in zip(objects[name]["fields"], record)}
    member = (lambda key: getattr(record, key)) if isinstance(record, messages.Table) else record.__getitem__
    return {field["name"]: element(field["kind"], field, member(field["name"])) for field in objects[name]["fields"]}


def table(read):
    form = {}
    for field in objects[read.kind]["fields"]:
        name, kind = field["name"], field["kind"]
        if kind in ("utype", "union"):
            continue  # of commands, which this client only writes
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
    """The kind of flaw that the client's sentence tells of."""
    for words, reason in (("schema_version", "version"), ("payload", "payload"), ("not a message of Wholehand's", "identifier")):
        if str(error).startswith(words):
            return reason
    return "damaged"


def read(data):
    """As the connection's listener reads it, then field by field."""
    try:
        message = messages.decode(data)
        connection.Connection(None)._hear(message)
        return {"payload": {message.kind: table(message)}}
    except messages.MessageError as error:
        return {"refused": reason_of(error)}
    except Exception as error:  # noqa: BLE001: the runner counts what escapes
        return {"escaped": repr(error)}


longest_s = 0.0


def timed_read(data):
    global longest_s
    began = time.monotonic()
    got = read(data)
    longest_s = max(longest_s, time.monotonic() - began)
    return got


def given(field, value):
    """A value of the form as this client takes it."""
    kind = field["element"] if field["kind"] == "vector" else field["kind"]
    def of(item):
        return struct.unpack(FORMATS[kind], bytes.fromhex(item))[0] if kind in FORMATS else item
    return numpy.array([of(item) for item in value], "<f4") if field["kind"] == "vector" else of(value)


def write(told):
    fields = {field["name"]: field for field in objects[told["order"]]["fields"]}
    return messages.encode(told["id"], told["order"],
                           **{name: given(fields[name], value) for name, value in told["fields"].items()})


answer = {"read": {told["name"]: timed_read(base64.b64decode(told["bytes"])) for told in job["read"]},
          "write": {told["name"]: base64.b64encode(write(told)).decode() for told in job["write"]},
          "longest_s": longest_s}
pathlib.Path(sys.argv[2]).write_text(json.dumps(answer), encoding="utf-8")
