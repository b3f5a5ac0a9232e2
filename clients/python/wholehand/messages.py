"""Messages of the protocol as Python values; protocol/wholehand.fbs explains every field."""
from __future__ import annotations

import importlib
import math
import re
import struct
import types
import typing

import flatbuffers
import numpy
import numpy.typing

Reals = numpy.typing.NDArray[numpy.float64]
Structs = numpy.typing.NDArray[numpy.void]
AnyArray = numpy.typing.NDArray[typing.Any]

SCHEMA_VERSION = 1
IDENTIFIER = b"WHND"

VEC3 = numpy.dtype(("<f4", 3))
POSE = numpy.dtype([("position_m", "<f4", 3), ("orientation_xyzw", "<f4", 4)])
CONTACT = numpy.dtype([("capsule", "<i2"), ("body", "<i2"), ("point_m", "<f4", 3), ("force_n", "<f4", 3)])
EVENT = numpy.dtype([("tick", "<u8"), ("type", "<u2"), ("index", "<i2"), ("value", "<f4")])
STATISTICS = numpy.dtype([("ticks", "<u8"), ("missed_deadlines", "<u8"), ("dropped_records", "<u8"),
                          ("cpu_p50_us", "<f4"), ("cpu_p99_us", "<f4"), ("cpu_p999_us", "<f4"),
                          ("cpu_max_us", "<f4")])
GAME_BODY = numpy.dtype({"names": ["slot", "generation", "shapes", "state"], "formats": ["<u4", "<u4", "<u4", "u1"],
                         "itemsize": 16})
REGISTERED_BODY = numpy.dtype({"names": ["number", "generation", "shapes", "slot", "whereabouts", "pose"],
                               "formats": ["<u4", "<u4", "<u4", "<i4", "u1", POSE],
                               "offsets": [0, 4, 8, 12, 16, 20], "itemsize": 48})
STRUCTS = {"Vec3": VEC3, "Pose": POSE, "ContactPoint": CONTACT, "Event": EVENT, "Statistics": STATISTICS,
           "GameBody": GAME_BODY, "RegisteredBody": REGISTERED_BODY}
VECTORS_OF_STRUCTS = {("WorldState", "links"): POSE, ("WorldState", "bodies"): POSE,
                      ("WorldState", "contacts"): CONTACT, ("Events", "events"): EVENT, ("Shape", "points_m"): VEC3,
                      ("GameBodies", "bodies"): GAME_BODY, ("GameBodies", "registered"): REGISTERED_BODY}

# Exceptions of flatbuffers for invalid bytes.
UNREADABLE = (struct.error, IndexError, ValueError, TypeError, OverflowError)


class MessageError(ValueError):
    """The bytes are not a message of this protocol."""


def _generated(name: str) -> types.ModuleType:
    """The generated class of a table, an enum or a union."""
    return importlib.import_module(f"wholehand.protocol.{name}")


def _names(enum: str) -> dict[int, str]:
    """Number -> name."""
    members = vars(getattr(_generated(enum), enum))
    return {number: name for name, number in members.items() if not name.startswith("_")}


PAYLOADS = _names("Payload")
ORDERS = {name: number for number, name in _names("Order").items() if number > 0}
REFUSALS = _names("Refusal")
BODY_REFUSALS = _names("BodyRefusal")
SLOT_STATES = _names("SlotState")
WHEREABOUTS = _names("Whereabouts")
RUN_STATES = _names("RunState")


class Table:
    """A table of a message. Its fields have the names of the schema: `state.q_s`, `scene.axes[0].name`.

    A vector of numbers is a numpy array, one of structs a structured array, one of tables a list. An absent vector is
    empty, an absent table or string None. Arrays are views of the message: copy what is changed.
    """
    __slots__ = ("_generated", "kind")

    def __init__(self, generated: typing.Any) -> None:
        self._generated = generated
        self.kind = type(generated).__name__

    def __getattr__(self, name: str) -> typing.Any:
        read = _reader(type(self._generated), name)
        try:
            return read(self._generated)
        except UNREADABLE as error:
            raise MessageError(f"{self.kind}.{name} cannot be read: {error}") from error

    def __dir__(self) -> list[str]:
        return ["kind", *field_names(type(self._generated))]

    def __repr__(self) -> str:
        return f"<{self.kind}>"


def _camel(name: str) -> str:
    return "".join(part[:1].upper() + part[1:] for part in name.split("_"))


Read = typing.Callable[[typing.Any], typing.Any]
_readers: dict[tuple[type, str], Read] = {}


def _reader(table: type, name: str) -> Read:
    """The function that reads a field of a generated class."""
    read = _readers.get((table, name))
    if read is None:
        if name.startswith("_") or not hasattr(table, _camel(name)):
            raise AttributeError(f"{table.__name__} has no field {name!r}; it has {', '.join(field_names(table))}")
        read = _readers[table, name] = _make_reader(table, name)
    return read


def _make_reader(table: type, name: str) -> Read:
    get = getattr(table, _camel(name))
    if hasattr(table, _camel(name) + "AsNumpy"):
        numbers = getattr(table, _camel(name) + "AsNumpy")
        return lambda t: _numbers(numbers(t))
    if not hasattr(table, _camel(name) + "Length"):
        return lambda t: _value(get(t))
    length = getattr(table, _camel(name) + "Length")
    structs = VECTORS_OF_STRUCTS.get((table.__name__, name))
    if structs is not None:
        kind = structs
        return lambda t: _structs(kind, get(t, 0)._tab, length(t)) if length(t) else numpy.empty(0, kind)
    return lambda t: [_value(get(t, i)) for i in range(_believable(length(t), t))]


def _numbers(array: typing.Any) -> AnyArray:
    return array if isinstance(array, numpy.ndarray) else numpy.empty(0)  # absent: 0


def _structs(dtype: numpy.dtype[typing.Any], first: typing.Any, count: int) -> AnyArray:
    return numpy.frombuffer(first.Bytes, dtype, count, first.Pos)


def _believable(count: int, table: typing.Any) -> int:
    """The count of a vector's elements; raises ValueError if they do not fit into the message."""
    if 4 * count > len(table._tab.Bytes):
        raise ValueError(f"{count} elements do not fit into {len(table._tab.Bytes)} bytes")
    return count


def _value(value: typing.Any) -> typing.Any:
    if isinstance(value, bytes):
        return value.decode()
    if not hasattr(value, "_tab"):
        return value
    dtype = STRUCTS.get(type(value).__name__)
    return Table(value) if dtype is None else _structs(dtype, value._tab, 1)[0]


def field_names(table: type) -> list[str]:
    """Names of a table's fields, from the accessors of its generated class, which flatc names in camel case."""
    own = [name for name in vars(table) if name[0].isupper() and name != "Init" and not name.startswith("GetRootAs")]
    helpers = ("AsNumpy", "Length", "IsNone", "BufferHasIdentifier")
    return [re.sub(r"(?<!^)(?=[A-Z])", "_", name).lower() for name in own if not name.endswith(helpers)]


def decode(data: typing.Any) -> Table:
    """The table in a message of the program. Raises MessageError."""
    data = bytes(data)
    if len(data) < 8 or data[4:8] != IDENTIFIER:
        raise MessageError("not a message of Wholehand's")
    try:
        message = _generated("Message").Message.GetRootAs(data, 0)
        version, kind, payload = message.SchemaVersion(), message.PayloadType(), message.Payload()
        name = PAYLOADS.get(kind)
        table = getattr(_generated(name), name)() if payload is not None and kind != 0 and name else None
        if table is not None:
            table.Init(payload.Bytes, payload.Pos)
    except UNREADABLE as error:
        raise MessageError(f"not a message: {error}") from error
    if version != SCHEMA_VERSION:
        raise MessageError(f"schema_version = {version}; this client reads {SCHEMA_VERSION}: "
                           "bring program and client to the same version")
    if table is None:
        raise MessageError(f"payload {kind} is not known to this client")
    return Table(table)


def encode(number: int, order: str, **fields: typing.Any) -> bytes:
    """A Command. @param number increases with every command @param fields fields of the order's table, as in the
    schema; for bodies and pieces a function of wholehand.bodies"""
    if order not in ORDERS:
        raise ValueError(f"there is no order {order!r}; there are {', '.join(ORDERS)}")
    builder = flatbuffers.Builder(256)
    module = _generated(order)
    for name in fields:
        if not hasattr(module, f"{order}Add{_camel(name)}"):
            raise ValueError(f"{order} has no field {name!r}")
    values = {name: _put(builder, value) for name, value in fields.items()}
    command = made(builder, _generated("Command"), id=number, order_type=ORDERS[order],
                   order=made(builder, module, **values))
    message = made(builder, _generated("Message"), schema_version=SCHEMA_VERSION,
                   payload_type=_generated("Payload").Payload.Command, payload=command)
    builder.Finish(message, IDENTIFIER)
    return bytes(builder.Output())


def made(builder: flatbuffers.Builder, module: types.ModuleType, **values: typing.Any) -> typing.Any:
    """A table. @param module of its generated class @param values of its fields; a function makes a struct in its place"""
    name = module.__name__.rpartition(".")[2]
    getattr(module, f"{name}Start")(builder)
    for field, value in values.items():
        getattr(module, f"{name}Add{_camel(field)}")(builder, value(builder) if callable(value) else value)
    return getattr(module, f"{name}End")(builder)


def _put(builder: flatbuffers.Builder, value: typing.Any) -> typing.Any:
    if callable(value):
        return value(builder)
    if isinstance(value, str):
        return builder.CreateString(value)
    if isinstance(value, (list, tuple, numpy.ndarray)):
        return builder.CreateNumpyVector(_single(value))
    return value


def _single(values: numpy.typing.ArrayLike) -> AnyArray:
    """Numbers in single precision, as in vectors of the wire, whose maximum is 3.4e38."""
    with numpy.errstate(over="ignore"):
        return numpy.asarray(values, "<f4")


def check_finite(order: str, fields: dict[str, typing.Any]) -> None:
    """Raises ValueError for an order with a number that is not finite, which no program accepts."""
    for name, value in fields.items():
        if isinstance(value, (float, numpy.floating)) and not math.isfinite(value):
            raise ValueError(f"{order}.{name} = {value}: must be finite")
        if isinstance(value, (list, tuple, numpy.ndarray)):
            for i in numpy.flatnonzero(~numpy.isfinite(_single(value))):
                raise ValueError(f"{order}.{name}[{i}] = {numpy.ravel(value)[i]}: must be finite in single precision")
