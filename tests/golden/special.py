"""Messages that are not examples of a table: valid ones of other builders and later schemas, and damaged ones."""
import copy
import struct

from forms import Schema, f32, f64


def put(data, at, form, value):
    data = bytearray(data)
    struct.pack_into(form, data, at, value)
    return bytes(data)


def place_of(data, slot):
    """Position of a field of the root table. @param slot its position in the vtable [bytes]"""
    root, = struct.unpack_from("<I", data)
    vtable = root - struct.unpack_from("<i", data, root)[0]
    return root + struct.unpack_from("<H", data, vtable + slot)[0]


def messages(schema):
    """Yields (name, description, bytes)."""
    def of(payload, **more):
        return schema.encode({"payload": payload}, **more)

    def command(order, fields, number=7):
        return of({"Command": {"id": number, "order": {order: fields}}})

    state = of({"WorldState": {"session": 3, "q_m": [f32(0.25), f32(-0.5), "80000000"], "values": [f64(1e-7), f64(-0.0)],
                               "links": [schema.example("Pose", "full")], "fault_axis": 2}})
    reply = of({"Reply": {"command": 7, "reason": "because it is so"}})
    aim = command("Aim", {"q": [f32(0.1), f32(-0.2), f32(0.3)]})
    root, = struct.unpack_from("<I", state)
    numbers = state.index(struct.pack("<ff", 0.25, -0.5)) - 4
    text = reply.index(b"because") - 4
    later = copy.copy(schema)
    later.objects = copy.deepcopy(schema.objects)
    later.objects["WorldState"]["fields"].append({"name": "of_tomorrow", "id": 1 + max(
        field["id"] for field in later.objects["WorldState"]["fields"]), "kind": "string"})
    of_tomorrow = Schema.encode(later, {"payload": {"WorldState": {"session": 3, "of_tomorrow": "new"}}})

    # Valid: read as the form says.
    yield "sound_state", "numbers that JSON and decimal digits lose", state
    yield "sound_explicit_defaults", "every scalar on the wire, as a builder may write it", of(
        {"WorldState": {"session": 3}}, explicit_defaults=True)
    yield "sound_later_schema", "a field that a later schema has added: ignored", of_tomorrow
    yield "sound_unknown_enum", "an enum value of a later schema: a number", of({"WorldState": {"run_state": 99, "help": 77}})
    yield "sound_followed_by_rubbish", "bytes behind the message", reply + b"\xff" * 9
    # Valid, but refused by the program.
    yield "order_aim_nan", "an aim that is no number", command("Aim", {"q": [f32(0.1), "7fc00000"]})
    yield "order_aim_17_axes", "an aim of more axes than there can be", command("Aim", {"q": [f32(0.1)] * 17})
    yield "order_aim_16_axes", "an aim of as many axes as there can be", command("Aim", {"q": [f32(0.1)] * 16})
    yield "order_aim_help_unknown", "no help of that number", command("Aim", {"q": [f32(0.1)], "by": 4})
    yield "order_parameter_infinite", "a value that is not finite", command("SetParameter", {"name": "a", "value": f64(float("inf"))})
    yield "order_steer_unknown", "nobody of that number steers", command("Steer", {"by": 2})
    yield "order_act_unknown", "no act of that number", command("Action", {"act": 4})
    yield "order_act_negative", "no act of that number", command("Action", {"act": -1})
    yield "order_help_unknown", "no help of that number", command("SetHelp", {"help": 4})
    yield "order_none", "a command without an order", of({"Command": {"id": 7}})
    yield "order_id_0", "a command without a number", command("Stop", {}, 0)
    yield "order_id_largest", "the largest number of a command", command("Stop", {}, 0xffffffff)
    yield "order_oversized", "a client's message of more than 40,960 bytes", command("TakeControls", {"token": "x" * 40961})
    # Damaged.
    yield "flaw_empty", "no byte", b""
    yield "flaw_7_bytes", "shorter than the identifier's end", state[:7]
    yield "flaw_8_bytes", "nothing behind the identifier", state[:8]
    yield "flaw_text", "a text", b"HTTP/1.1 200 OK\r\n\r\n"
    yield "flaw_identifier", "of another program", put(state, 4, "4s", b"ABCD")
    yield "flaw_zeros", "zeros behind the identifier", b"\0\0\0\0WHND" + bytes(64)
    yield "flaw_version_0", "of no version", put(state, place_of(state, 4), "<H", 0)
    yield "flaw_version_65535", "of another version", put(state, place_of(state, 4), "<H", 65535)
    for part in (12, 20, 40, len(state) // 2, len(state) - 1):
        yield f"flaw_cut_{part}", f"cut after {part} of {len(state)} bytes", state[:part]
    yield "flaw_cut_aim", "a client's message that is cut", aim[:-8]
    yield "flaw_root_beyond", "the root lies behind the end", put(state, 0, "<I", len(state) + 100)
    yield "flaw_root_huge", "the root lies 4 GB away", put(state, 0, "<I", 0xfffffff0)
    yield "flaw_vtable_beyond", "the table's fields are described behind the end", put(state, root, "<i", -len(state) - 50)
    yield "flaw_vtable_before", "the table's fields are described before the beginning", put(state, root, "<i", root + 50)
    yield "flaw_vector_longer", "a vector of one number too many for the message", put(state, numbers, "<I", len(state))
    yield "flaw_vector_huge", "a vector of 2^32 - 1 numbers", put(state, numbers, "<I", 0xffffffff)
    yield "flaw_vector_2_31", "a vector of 2^31 - 1 numbers", put(state, numbers, "<I", 0x7fffffff)
    yield "flaw_text_huge", "a text of 2 GB", put(reply, text, "<I", 0x7fffffff)
    yield "flaw_text_longer", "a text that goes on behind the end", put(reply, text, "<I", len(reply))
    yield "flaw_payload_beyond", "the payload lies 4 GB away", put(reply, place_of(reply, 8), "<I", 0xfffffff0)
    yield "flaw_payload_none", "no payload", schema.encode({})
    yield "flaw_payload_unknown", "a payload of a later schema", put(reply, place_of(reply, 6), "<B", 200)
