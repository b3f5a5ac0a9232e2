"""A minimal client of the program for the end-to-end tests: docs/protocol.md, docs/udp.md."""
import base64
import os
import socket
import struct
import threading
import time
import zlib

from app import HANG_S

# Numbers of the members of the unions Order and Payload in protocol/wholehand.fbs, from 1.
ARM, STOP, EMERGENCY_STOP, SET_PARAMETER, AIM, STEER, ACTION, TAKE_CONTROLS, HEARTBEAT, SAVE_PROFILE = \
    1, 2, 3, 5, 6, 7, 8, 9, 11, 13
WORLD_STATE, SCENE, WELCOME, REPLY, COMMAND = 1, 2, 4, 6, 7
ENDINGS, DEVICE_STATE, BASIS = 32, 33, 40  # fields of WorldState
SILENT, STOP_PENDING, STOP_UNCONFIRMED, LOOP_AGE = 41, 42, 43, 44
PERSON = 1


def encode(table):
    """Returns a finished buffer. A table is a list of fields: (struct format, number), a table, a text, or the floats of
    a vector as bytes; every field is given."""
    buffer = bytearray(struct.pack("<I4s", 0, b"WHND"))
    struct.pack_into("<I", buffer, 0, _put(buffer, table))
    return bytes(buffer)


def _put(buffer, fields):
    slot = 8 if any(isinstance(field, tuple) and struct.calcsize(field[0]) == 8 for field in fields) else 4
    vtable = len(buffer)
    buffer += struct.pack("<HH", 4 + 2 * len(fields), slot + slot * len(fields))
    buffer += b"".join(struct.pack("<H", slot + slot * i) for i in range(len(fields)))
    buffer += bytes(-len(buffer) % slot)
    at = len(buffer)
    buffer += struct.pack("<i", at - vtable).ljust(slot, b"\0") + bytes(slot * len(fields))
    for i, field in enumerate(fields):
        place = at + slot + slot * i
        if isinstance(field, list):
            struct.pack_into("<I", buffer, place, _put(buffer, field) - place)
        elif isinstance(field, str):
            buffer += bytes(-len(buffer) % 4)
            struct.pack_into("<I", buffer, place, len(buffer) - place)
            buffer += struct.pack("<I", len(field.encode())) + field.encode() + b"\0"
        elif isinstance(field, bytes):
            buffer += bytes(-len(buffer) % 4)
            struct.pack_into("<I", buffer, place, len(buffer) - place)
            buffer += struct.pack("<I", len(field) // 4) + field
        else:
            struct.pack_into("<" + field[0], buffer, place, field[1])
    return at


def command(version, number, order, fields=()):
    return encode([("H", version), ("B", COMMAND), [("I", number), ("B", order), list(fields)]])


class Table:
    """Reads the fields of a table in a buffer."""

    def __init__(self, buffer, at):
        self.buffer, self.at = buffer, at

    def number(self, index, form, otherwise=0):
        vtable = self.at - struct.unpack_from("<i", self.buffer, self.at)[0]
        if 4 + 2 * index >= struct.unpack_from("<H", self.buffer, vtable)[0]:
            return otherwise
        offset = struct.unpack_from("<H", self.buffer, vtable + 4 + 2 * index)[0]
        return struct.unpack_from("<" + form, self.buffer, self.at + offset)[0] if offset else otherwise

    def inner(self, index):
        vtable = self.at - struct.unpack_from("<i", self.buffer, self.at)[0]
        place = self.at + struct.unpack_from("<H", self.buffer, vtable + 4 + 2 * index)[0]
        return Table(self.buffer, place + struct.unpack_from("<I", self.buffer, place)[0])

    def texts(self, index):
        """The texts of a vector of strings."""
        at = self.inner(index).at
        count = struct.unpack_from("<I", self.buffer, at)[0]
        places = [at + 4 + 4 * i for i in range(count)]
        return [self._text(place + struct.unpack_from("<I", self.buffer, place)[0]) for place in places]

    def doubles(self, index):
        at = self.inner(index).at
        return struct.unpack_from(f"<{struct.unpack_from('<I', self.buffer, at)[0]}d", self.buffer, at + 4)

    def floats(self, index):
        at = self.inner(index).at
        return struct.unpack_from(f"<{struct.unpack_from('<I', self.buffer, at)[0]}f", self.buffer, at + 4)

    def text(self, index):
        return self._text(self.inner(index).at)

    def _text(self, at):
        return self.buffer[at + 4:at + 4 + struct.unpack_from("<I", self.buffer, at)[0]].decode()


def decode(buffer):
    """(kind, table) of a message."""
    message = Table(buffer, struct.unpack_from("<I", buffer, 0)[0])
    return message.number(1, "B"), message.inner(2)


class Page:
    """A WebSocket client. After hold_controls() it sends a heartbeat every 50 ms, until fall_silent()."""

    def __init__(self, port, role=None):
        path = f"/ws?role={role}" if role else "/ws"
        self.socket = socket.create_connection(("127.0.0.1", port), timeout=HANG_S)
        self.socket.setsockopt(socket.IPPROTO_TCP, socket.TCP_NODELAY, 1)
        key = base64.b64encode(os.urandom(16)).decode()
        self.socket.sendall(f"GET {path} HTTP/1.1\r\nHost: 127.0.0.1:{port}\r\nUpgrade: websocket\r\n"
                            f"Connection: Upgrade\r\nSec-WebSocket-Key: {key}\r\n"
                            "Sec-WebSocket-Version: 13\r\n\r\n".encode())
        self.bytes = b""
        while b"\r\n\r\n" not in self.bytes:
            self.bytes += self.socket.recv(65536)
        head, _, self.bytes = self.bytes.partition(b"\r\n\r\n")
        assert head.startswith(b"HTTP/1.1 101"), head
        self.replies = {}  # by command number: accepted, reason
        self.state = None  # the newest WorldState
        self.on_state = lambda state: None  # called in the listening thread
        self.scene = None
        self.answered = threading.Condition()
        self.version, self.last, self.lock = 1, 0, threading.Lock()
        self.alive = threading.Event()
        self.open = True
        threading.Thread(target=self._listen, daemon=True).start()

    def _listen(self):
        try:
            while self.open:
                self._hear()
        except OSError:
            self.open = False

    def _take(self, count):
        while len(self.bytes) < count:
            more = self.socket.recv(1 << 20)
            if not more:
                raise OSError("closed")
            self.bytes += more
        taken, self.bytes = self.bytes[:count], self.bytes[count:]
        return taken

    def _hear(self):
        kind, length = self._take(2)
        if length == 126:
            length = struct.unpack(">H", self._take(2))[0]
        elif length == 127:
            length = struct.unpack(">Q", self._take(8))[0]
        payload = self._take(length)
        if kind & 15 != 2:
            return
        what, table = decode(payload)
        if what == WORLD_STATE:
            self.state = table
            self.on_state(table)
        if what == SCENE:
            self.scene = table
        if what == REPLY:
            with self.answered:
                self.replies[table.number(0, "I")] = (bool(table.number(1, "B")), table.text(2))
                self.answered.notify_all()

    def say(self, order, *fields):
        """Sends an order and returns its number."""
        with self.lock:
            self.last += 1
            payload = command(self.version, self.last, order, fields)
            head = struct.pack(">BB", 0x82, 0x80 | len(payload)) if len(payload) < 126 else struct.pack(
                ">BBH", 0x82, 0xFE, len(payload))
            self.socket.sendall(head + bytes(4) + payload)  # a mask of zeros
            return self.last

    def answer(self, number, within_s=HANG_S):
        with self.answered:
            self.answered.wait_for(lambda: number in self.replies, within_s)
            return self.replies.get(number)

    def wait_for_endings(self, count):
        until = time.monotonic() + HANG_S
        while self.state is None or self.state.number(ENDINGS, "I") < count:
            assert time.monotonic() < until, f"ending {count} is not reported"
            time.sleep(0.01)

    def arm(self, endings_seen):
        """Arms once the program has reported so many endings; returns whether it was accepted and the reason. An order
        that waited too long behind others, such as a slow end of a session, is repeated, as the program advises."""
        if endings_seen > 1:
            self.wait_for_endings(endings_seen)
        while True:
            accepted, reason = self._answer_while_heard(self.say(ARM, ("I", endings_seen), ("I", self.basis())))
            if accepted or not reason.endswith("look, then ask again"):
                return accepted, reason

    def act(self, act):
        """Orders an action of the exercise, as a page that shows the newest state; returns its number."""
        return self.say(ACTION, ("b", act), ("I", self.basis()))

    def basis(self):
        """The number of the person, hand, level and limits that the program has shown."""
        self.wait_for_endings(1)
        return self.state.number(BASIS, "I")

    def _answer_while_heard(self, number):
        """Sends heartbeats until the answer: nothing starts for a client that is not heard."""
        until = time.monotonic() + HANG_S
        while (answer := self.answer(number, 0.05)) is None and time.monotonic() < until:
            self.say(HEARTBEAT)
        return answer

    def hold_controls(self):
        assert self.answer(self.say(TAKE_CONTROLS))[0]
        self.alive.set()
        threading.Thread(target=self._beat, daemon=True).start()

    def _beat(self):
        while self.alive.is_set() and self.open:
            try:
                self.say(HEARTBEAT)
            except OSError:
                return
            time.sleep(0.05)

    def fall_silent(self):
        with self.lock:
            self.alive.clear()
            return time.monotonic()

    def close(self):
        self.open = False
        self.alive.clear()
        # Resets the connection, as a killed browser does.
        self.socket.setsockopt(socket.SOL_SOCKET, socket.SO_LINGER, struct.pack("ii", 1, 0))
        self.socket.shutdown(socket.SHUT_RDWR)


class Game:
    """A game that uses UDP only, with the program's --udp-key, and stores the states of the loop as they arrive:
    (time of arrival, tick, faults, authority)."""

    KEY = "0123456789abcdef"

    def __init__(self, port, rate_hz):
        self.socket = socket.socket(socket.AF_INET, socket.SOCK_DGRAM)
        self.socket.connect(("127.0.0.1", port))
        self.socket.setsockopt(socket.SOL_SOCKET, socket.SO_RCVBUF, 1 << 22)
        self.socket.settimeout(0.05)
        self.rate_hz, self.sequence, self.echo_ns, self.last, self.version = rate_hz, 0, 0, 0, 1
        self.lock = threading.Lock()
        self.states = []
        self.holds_controls = False
        self.open = True
        self.thread = threading.Thread(target=self._listen, daemon=True)
        self.thread.start()

    def _send(self, kind, payload=b""):
        with self.lock:
            self.sequence += 1
            head = struct.pack("<4sHBBQIIqqI", b"WHUD", 2, kind, 0, int(self.KEY, 16), self.sequence, self.rate_hz,
                               time.monotonic_ns(), self.echo_ns, 0)
            self.socket.send(head + struct.pack("<I", zlib.crc32(head + payload)) + payload)

    def _listen(self):
        beat = 0.0
        while self.open:
            if time.monotonic() > beat:
                self._send(2)
                beat = time.monotonic() + 0.05
            try:
                datagram = self.socket.recv(2048)
            except TimeoutError:
                continue
            except OSError:
                return
            self.holds_controls = datagram[7] == 1
            self.echo_ns = struct.unpack_from("<q", datagram, 24)[0]
            if datagram[6] == 16:
                _, state = decode(datagram[48:])
                self.states.append((time.monotonic(), state.number(1, "Q"), state.number(6, "I"),
                                    state.number(8, "f")))

    def say(self, order, *fields):
        self.last += 1
        self._send(1, command(self.version, self.last, order, fields))

    def close(self):
        self.open = False
        self.thread.join()
        self.socket.close()
