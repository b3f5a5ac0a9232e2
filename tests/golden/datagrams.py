"""Golden datagrams (docs/udp.md): valid ones, and one for every reason to ignore one."""
import struct
import zlib

from forms import f32
from special import place_of, put

KEY, OTHER_KEY = 0x1122334455667788, 0x1122334455667789
COMMAND, ALIVE, STATE, PRESENT = 1, 2, 16, 17
HEADER, LARGEST = 48, 1200


def datagram(kind, payload=b"", flags=0, key=KEY, sequence=5, number=0, sent=123456789, echo=0, age=0, magic=b"WHUD",
             version=2):
    head = struct.pack("<4sHBBQIIqqI", magic, version, kind, flags, key, sequence, number, sent, echo, age)
    return head + struct.pack("<I", zlib.crc32(payload, zlib.crc32(head))) + payload


def flipped(data, at):
    return data[:at] + bytes([data[at] ^ 1]) + data[at + 1:]


def datagrams(schema):
    """Yields (name, description, sender, names of the earlier datagrams of the conversation, reason to ignore it, bytes)."""
    def message(payload, **more):
        return schema.encode({"payload": payload}, **more)

    def command(order, fields, number=7):
        return message({"Command": {"id": number, "order": {order: fields}}})

    state = message({"WorldState": {"session": 3, "q_s": [f32(0.5), f32(-0.25)], "tick": "00000000000003e8"}})
    aim, stop = command("Aim", {"q": [f32(0.1), f32(-0.2)]}), command("EmergencyStop", {})
    sound = datagram(STATE, state)
    said = {
        "state": ("a state", sound),
        "state_held": ("a state for the game that has the controls", datagram(STATE, state, flags=1)),
        "state_largest": ("a state of 1,200 bytes", datagram(STATE, state + bytes(LARGEST - HEADER - len(state)))),
        "state_all_header": ("every field of the header at its end", datagram(
            STATE, state, 1, sequence=0x7fffffff, number=0xffffffff, sent=-1, echo=(1 << 63) - 1, age=0xffffffff)),
        "state_negative_times": ("times before the clock's zero", datagram(STATE, state, sent=-(1 << 63), echo=-2)),
        "state_stop_obeyed": ("a state that confirms stop 7", datagram(STATE, state, number=7)),
        "state_1": ("the first of a conversation", datagram(STATE, state, sequence=1)),
        "present": ("no payload", datagram(PRESENT)),
        "present_held": ("no payload, for the game that has the controls", datagram(PRESENT, flags=1)),
        "present_echo": ("echoes a time after 4 µs", datagram(PRESENT, echo=3, age=4)),
    }
    for name, (about, data) in said.items():
        yield f"program_{name}", about, "program", [], "", data
    yield "program_later", "numbers may be left out", "program", ["program_state"], "", datagram(STATE, state, sequence=900)
    yield ("program_wrapped", "numbers go on from 0", "program", ["program_state_all_header", "program_highest"], "",
           datagram(STATE, state, sequence=2))
    yield ("program_highest", "the highest number", "program", ["program_state_all_header"], "",
           datagram(STATE, state, sequence=0xfffffff0))
    yield "program_repeated", "came twice", "program", ["program_state"], "stale", sound
    yield "program_older", "older than one before", "program", ["program_state"], "stale", datagram(STATE, state, sequence=4)
    yield "program_foreign_key", "of another conversation", "program", [], "key", datagram(STATE, state, key=OTHER_KEY)
    yield "program_says_alive", "what only a game says", "program", [], "header", datagram(ALIVE)
    yield "program_says_command", "what only a game says", "program", [], "header", datagram(COMMAND, stop)
    yield "program_no_state", "a state that is a reply", "program", [], "message", datagram(
        STATE, message({"Reply": {"command": 7}}))
    yield "program_rubbish", "a state that is no message", "program", [], "message", datagram(STATE, b"rubbish, all of it")
    yield "program_state_version_65535", "a state of another schema", "program", [], "message", datagram(
        STATE, put(state, place_of(state, 4), "<H", 65535))
    flaws = {
        "empty": ("too_short", b""), "47_bytes": ("too_short", sound[:47]), "1201_bytes": ("too_long", sound + bytes(
            LARGEST + 1 - len(sound))),
        "magic": ("magic", datagram(STATE, state, magic=b"WHUE")), "version_1": ("version", datagram(STATE, state, version=1)),
        "version_65535": ("version", datagram(STATE, state, version=65535)), "cut": ("checksum", sound[:-1]),
        "longer": ("checksum", sound + b"\0"), "flipped_key": ("checksum", flipped(sound, 8)),
        "flipped_checksum": ("checksum", flipped(sound, 44)), "flipped_payload": ("checksum", flipped(sound, len(sound) - 1)),
        "kind_0": ("header", datagram(0, state)), "kind_3": ("header", datagram(3)), "kind_255": ("header", datagram(255, state)),
        "flags_2": ("header", datagram(STATE, state, flags=2)), "flags_255": ("header", datagram(PRESENT, flags=255)),
        "state_without_payload": ("header", datagram(STATE)), "present_with_payload": ("header", datagram(PRESENT, state)),
    }
    for name, (reason, data) in flaws.items():
        yield f"flaw_{name}", f"refused: {reason}", "program", [], reason, data
    for name, about, data in (("alive", "a sign of life", datagram(ALIVE)),
                              ("alive_1000_hz", "asks for 1000 states a second", datagram(ALIVE, number=1000)),
                              ("heartbeat", "a heartbeat", datagram(COMMAND, command("Heartbeat", {}, 0), sequence=6)),
                              ("aim", "an aim", datagram(COMMAND, aim, sequence=7)),
                              ("emergency_stop", "an emergency stop", datagram(COMMAND, stop, sequence=8))):
        yield f"game_{name}", about, "game", [], "", data
    yield "game_1001_hz", "asks for more states than there are", "game", [], "header", datagram(ALIVE, number=1001)
    yield "game_flags_1", "a game says who has the controls", "game", [], "header", datagram(ALIVE, flags=1)
    yield "game_command_empty", "a command without a message", "game", [], "header", datagram(COMMAND)
    yield "game_alive_with_payload", "a sign of life with a message", "game", [], "header", datagram(ALIVE, aim)
    yield "game_says_state", "what only the program says", "game", [], "header", datagram(STATE, state)
    yield "game_foreign_key", "of no conversation", "game", [], "key", datagram(ALIVE, key=OTHER_KEY)
    yield "game_repeated", "came twice", "game", ["game_alive"], "stale", datagram(ALIVE)
    yield "game_older", "older than one before", "game", ["game_aim"], "stale", datagram(ALIVE, sequence=6)
    yield "game_stop_late", "a late emergency stop: obeyed, its header is not followed", "game", ["game_emergency_stop"], "stale", \
        datagram(COMMAND, stop, sequence=3)
    yield "game_take_controls", "an order that goes by WebSocket", "game", [], "message", datagram(
        COMMAND, command("TakeControls", {}))
    yield "game_aim_nan", "an aim that is no number", "game", [], "message", datagram(
        COMMAND, command("Aim", {"q": ["7fc00000"]}))
    yield "game_rubbish", "a command that is no message", "game", [], "message", datagram(COMMAND, b"WHND rubbish")
