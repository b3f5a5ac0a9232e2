"""Canonical forms of messages: examples of every table, and their bytes. docs/protocol.md, "Golden messages"."""
import json
import struct
import subprocess

import flatbuffers
from flatbuffers import number_types

IDENTIFIER = b"WHND"
WIDTHS = {"bool": 1, "i8": 1, "u8": 1, "i16": 2, "u16": 2, "i32": 4, "u32": 4, "i64": 8, "u64": 8, "f32": 4, "f64": 8}
UNSIGNED = {1: number_types.Uint8Flags, 2: number_types.Uint16Flags, 4: number_types.Uint32Flags,
            8: number_types.Uint64Flags}
BITS = ("i64", "u64", "f32", "f64")  # written as hexadecimal digits of their bits


def bits_of(kind, value):
    """A number of the canonical form as an unsigned integer."""
    width = WIDTHS[kind]
    bits = int(value, 16) if kind in BITS else int(value)
    return bits & ((1 << 8 * width) - 1)


def f32(value):
    return struct.pack(">f", value).hex()


def f64(value):
    return struct.pack(">d", value).hex()


def i64(value):
    return f"{value & 0xffffffffffffffff:016x}"


class Schema:
    """The schema as `golden_judge layout` prints it."""

    def __init__(self, judge, compiled):
        printed = subprocess.run([judge, "layout", compiled], capture_output=True, text=True)
        if printed.returncode != 0:
            raise RuntimeError(printed.stderr)
        self.layout = json.loads(printed.stdout)
        self.version = self.layout["schema_version"]
        self.objects, self.enums = self.layout["objects"], self.layout["enums"]

    def named(self, name):
        """Name of a golden message of this version; messages of older versions keep their names."""
        return name if self.version == 1 else f"{name}_v{self.version}"

    def members(self, union):
        return [name for name, value in self.enums[union]["values"].items() if value != 0]

    def payload_of(self, table):
        """The canonical form of a message with this table: a payload, or an order of a client."""
        if table in self.members("Payload"):
            return lambda form: {"payload": {table: form}}
        if table in self.members("Order"):
            return lambda form: {"payload": {"Command": {"id": 7, "order": {table: form}}}}
        raise KeyError(f"{table} is neither a payload nor an order; payloads: {', '.join(self.members('Payload'))}; "
                       f"orders: {', '.join(self.members('Order'))}")

    def fields_in(self, table, form):
        """Yields (table, field) for every field that a form has."""
        seen = set()
        for field in self.objects[table]["fields"]:
            if field["name"] not in form:
                continue
            seen.add((table, field["name"]))
            value = form[field["name"]]
            if field["kind"] == "union":
                (member, inner), = value.items()
                seen |= self.fields_in(member, inner)
            elif field.get("of") in self.objects:
                for inner in value if field["kind"] == "vector" else [value]:
                    seen |= self.fields_in(field["of"], inner)
        return seen

    # ---- examples ----

    def example(self, table, variant, depth=0):
        """@param variant `full`: every field has its own value; `extreme`: the limits of every type"""
        form = {}
        for field in self.objects[table]["fields"]:
            if field["kind"] == "utype":
                continue
            seed = field["id"] + 3 * depth
            value = self._value(field, field["kind"], variant, seed, depth)
            if self.objects[table]["struct"] or value not in ("", [], {}, None, field.get("default")):
                form[field["name"]] = value
        return form

    def _value(self, field, kind, variant, seed, depth):
        if kind == "vector":
            count = 2 if variant == "full" else (1 - seed % 2) * 5
            return [self._value(field, field["element"], variant, seed + i, depth) for i in range(count)]
        if kind == "union":
            return None  # a union of a nested table has its own example
        if kind in ("table", "struct"):
            return self.example(field["of"], variant, depth + 1) if depth < 6 else None
        if kind == "string":
            return f"{field['name']} {seed}" if variant == "full" else ["", "\"\\\n\t", "Größe 手 🖐", "x" * 300][seed % 4]
        if field.get("of"):
            values = sorted(self.enums[field["of"]]["values"].values())
            return values[-1] if variant == "extreme" else values[seed % len(values)]
        return number(kind, variant, seed)

    # ---- bytes ----

    def encode(self, form, explicit_defaults=False):
        """@param explicit_defaults also writes scalars with their default value, as a builder may"""
        builder = flatbuffers.Builder(1024)
        builder.ForceDefaults(explicit_defaults)
        form = {"schema_version": self.version, **form}
        builder.Finish(self._table(builder, "Message", form), IDENTIFIER)
        return bytes(builder.Output())

    def _table(self, builder, table, form):
        fields = self.objects[table]["fields"]
        unknown = set(form) - {field["name"] for field in fields}
        if unknown:
            raise ValueError(f"{table} has no field {', '.join(sorted(unknown))}; "
                             f"it has {', '.join(field['name'] for field in fields)}")
        placed = {field["name"]: self._outside(builder, field, form[field["name"]]) for field in fields
                  if field["name"] in form and field["kind"] in ("string", "vector", "table", "union")}
        unions = {f"{field['name']}_type": self._member(field, form[field["name"]]) for field in fields
                  if field["kind"] == "union" and field["name"] in form}
        builder.StartObject(1 + max((field["id"] for field in fields), default=-1))
        for field in fields:
            name, slot = field["name"], field["id"]
            if name in placed:
                builder.PrependUOffsetTRelativeSlot(slot, placed[name], 0)
            elif name in unions:
                builder.PrependUint8Slot(slot, unions[name], 0)
            elif field["kind"] == "struct" and name in form:
                builder.PrependStructSlot(slot, self._struct(builder, field["of"], form[name]), 0)
            elif field["kind"] in WIDTHS:
                value = bits_of(field["kind"], form.get(name, field["default"]))
                builder.PrependSlot(UNSIGNED[WIDTHS[field["kind"]]], slot, value, bits_of(field["kind"], field["default"]))
        return builder.EndObject()

    def _member(self, field, value):
        (member, _), = value.items()
        return self.enums[field["of"]]["values"][member]

    def _outside(self, builder, field, value):
        """Writes an object to which a table refers; it comes before the table."""
        if field["kind"] == "string":
            return builder.CreateString(value)
        if field["kind"] == "table":
            return self._table(builder, field["of"], value)
        if field["kind"] == "union":
            (member, form), = value.items()
            return self._table(builder, member, form)
        kind = field["element"]
        if kind in ("table", "string"):
            offsets = [builder.CreateString(item) if kind == "string" else self._table(builder, field["of"], item)
                       for item in value]
            builder.StartVector(4, len(value), 4)
            for offset in reversed(offsets):
                builder.PrependUOffsetTRelative(offset)
            return builder.EndVector()
        if kind == "struct":
            size, align = self.objects[field["of"]]["size"], self.objects[field["of"]]["align"]
        else:
            size = align = WIDTHS[kind]
        builder.StartVector(size, len(value), align)
        for item in reversed(value):
            if kind == "struct":
                self._struct(builder, field["of"], item)
            else:
                builder.Prepend(UNSIGNED[size], bits_of(kind, item))
        return builder.EndVector()

    def _struct(self, builder, name, form):
        size, align = self.objects[name]["size"], self.objects[name]["align"]
        builder.Prep(align, size)
        builder.head = builder.head - size
        builder.Bytes[builder.head:builder.head + size] = self._struct_bytes(name, form)
        return builder.Offset()

    def _struct_bytes(self, name, form):
        out = bytearray(self.objects[name]["size"])
        for field in self.objects[name]["fields"]:
            value, at = form[field["name"]], field["offset"]
            if field["kind"] == "struct":
                inner = self._struct_bytes(field["of"], value)
            else:
                inner = bits_of(field["kind"], value).to_bytes(WIDTHS[field["kind"]], "little")
            out[at:at + len(inner)] = inner
        return bytes(out)


def number(kind, variant, seed):
    full = variant == "full"
    if kind == "bool":
        return True
    if kind == "f32":
        return f32(0.1 * seed + 0.05) if full else ["7f7fffff", "80000001", "00000001", "ff800000", "7fc00000"][seed % 5]
    if kind == "f64":
        return f64(0.1 * seed + 0.05) if full else ["7fefffffffffffff", "8000000000000001", "0000000000000001",
                                                   "fff0000000000000", "7ff8000000000000"][seed % 5]
    width, signed = 8 * WIDTHS[kind], kind[0] == "i"
    if full:
        value = seed + 2
    else:
        value = -(1 << width - 1) if signed and seed % 2 else (1 << width - int(signed)) - 1
    return i64(value) if kind in BITS else value


def first_difference(expected, got, place="", part=False):
    """Describes where two forms differ; None if nowhere. @param part `expected` may lack fields that `got` has"""
    if isinstance(expected, dict) and isinstance(got, dict):
        for key in {**expected, **({} if part else got)}:
            if key not in got or key not in expected:
                return f"{place}.{key} is {'missing' if key not in got else 'there, and should not be'}"
            found = first_difference(expected[key], got[key], f"{place}.{key}", part)
            if found:
                return found
        return None
    if isinstance(expected, list) and isinstance(got, list) and len(expected) == len(got):
        for i, (a, b) in enumerate(zip(expected, got)):
            found = first_difference(a, b, f"{place}[{i}]", part)
            if found:
                return found
        return None
    if expected == got and isinstance(expected, bool) == isinstance(got, bool):
        return None
    return f"{place} is {got!r}, expected {expected!r}"
