"""A connection to a running program, for asyncio: docs/protocol.md.

    async with connect("127.0.0.1:8080", role="therapist") as program:
        await program.take_controls()
        await program.arm()
        await program.order("Steer", by=PERSON)
        while True:
            state = await program.next_state()
            await program.order("Aim", q=where_to_go(state))
"""
from __future__ import annotations

import asyncio
import collections
import contextlib
import time
import typing

from websockets.exceptions import ConnectionClosed, WebSocketException
from websockets.legacy.client import connect as open_socket

from wholehand import bodies as make
from wholehand.messages import BODY_REFUSALS, REFUSALS, WHEREABOUTS, MessageError, Reals, Table, check_finite, decode, encode
from wholehand.prediction import MotionPredictor

VIRTUAL_PATIENT, PERSON = 0, 1          # Steer.by
NEXT, RESTART, PAUSE, RESUME = range(4)  # Action.act

STARTS = ("Arm", "LoadExercise")
HEARTBEAT_S = 0.05          # the program takes the controls away after 0.2 s of silence
REPEAT_STOP_S = 0.3
ANSWER_WITHIN_S = 60.0      # arming includes a rehearsal of seconds, or more on a busy machine
MESSAGES_A_SECOND = 350.0   # the program drops messages beyond 400, also an Aim whose answer is awaited
AT_ONCE = 50.0              # size of a burst
EMPTY_BELOW_M = -8.0        # empty slots of a state are below this; a body of a game is within 5 m
BODY_EVENTS = 4096          # maximum number waiting for next_body_event(); older ones are dropped

Answer = typing.TypeVar("Answer")


class Refused(Exception):
    """The program refused an order. `code` is a name of the schema's Refusal. `items` are the refused items of an order
    to bodies, as (index, name of the schema's BodyRefusal, reason); all others were obeyed."""

    def __init__(self, order: str, reply: Table) -> None:
        self.order, self.reason = order, reply.reason
        self.code = REFUSALS.get(reply.refusal, "Other")
        self.items = [(item.item, BODY_REFUSALS.get(item.refusal, "Other"), item.reason) for item in reply.items]
        super().__init__(f"{order}: {self.reason} ({self.code})")


class Lost(ConnectionError):
    """The connection ended, or the program cannot be reached."""


class Unanswered(TimeoutError):
    """The program did not answer an order in time. It may still obey it."""

    def __init__(self, order: str, within_s: float) -> None:
        super().__init__(f"{order}: the program did not answer within {within_s:g} s; it hangs, or its machine is busy")


@contextlib.asynccontextmanager
async def connect(address: str = "127.0.0.1:8080", role: str | None = None, token: str | None = None,
                  answer_within_s: float = ANSWER_WITHIN_S) -> typing.AsyncIterator[Connection]:
    """@param address host:port @param role therapist, player or watcher; None: unspecified @param token for another
    machine
    @param answer_within_s every order is answered by then, or raises Unanswered"""
    if role not in (None, "therapist", "player", "watcher"):
        raise ValueError(f"role = {role!r}: must be therapist, player or watcher, or None")
    where = f"ws://{address}/ws" + (f"?role={role}" if role else "")
    headers = {"Authorization": f"Bearer {token}"} if token else {}
    try:
        socket = await open_socket(where, max_size=None, ping_interval=None, extra_headers=headers)
    except (OSError, WebSocketException, ValueError, asyncio.TimeoutError) as error:
        raise Lost(f"no program answers at {where}: {error}; start one with `wholehand run`") from error
    program = Connection(socket, answer_within_s)
    listening = asyncio.create_task(program._listen())
    try:
        await program._answered("connect", program._wait(lambda: program.scene or program.commissioning), None)
        yield program
    finally:
        program._beat_stops()
        listening.cancel()
        await socket.close()


class Connection:
    """The newest messages of the program: `welcome`, `scene`, `controls`, `state`, `commissioning`, `bodies`
    (Tables; `bodies` is the schema's GameBodies), `registered` (the schema's RegisteredBody by number), and
    orders to it. `silence` is called before every heartbeat; while it returns True none is sent."""

    def __init__(self, socket: typing.Any, answer_within_s: float = ANSWER_WITHIN_S) -> None:
        self._socket = socket
        self._answer_within_s = answer_within_s
        self._number = 0
        self._allowance, self._allowed_s = AT_ONCE, time.monotonic()
        self._replies: dict[int, asyncio.Future[Table]] = {}
        self._event_queues: set[asyncio.Queue[typing.Any]] = set()
        self._news = asyncio.Event()
        self._lost: Lost | None = None
        self._beat: asyncio.Task[None] | None = None
        self._event_names: list[str] = []
        self._body_events: collections.deque[make.BodyEvent] = collections.deque(maxlen=BODY_EVENTS)
        # Names of a game's bodies by slot, also of those that have left it: (number, generation).
        self._generations: dict[int, int] = {}
        self._names: dict[int, tuple[int, int]] = {}
        self.registered: dict[int, typing.Any] = {}
        self._motion = MotionPredictor()
        self.silence: typing.Callable[[], bool] = lambda: False
        self.welcome: Table | None = None
        self.scene: Table | None = None
        self.controls: Table | None = None
        self.state: Table | None = None
        self.commissioning: Table | None = None
        self.bodies: Table | None = None

    async def order(self, order: str, timeout_s: float | None = None, **fields: typing.Any) -> None:
        """Sends one of the schema's Order and waits for the answer. Raises Refused, Lost, Unanswered, and
        ValueError for invalid arguments, such as a number that is not finite.
        @param timeout_s replaces the connection's answer_within_s"""
        with self._heard(order):
            await self._answered(order, self._ask(order, fields), timeout_s)

    @contextlib.contextmanager
    def _heard(self, order: str) -> typing.Iterator[None]:
        """Sends heartbeats until an order that starts the device is answered: nothing starts for a silent client."""
        beat = None
        if order in STARTS and self._beat is None:
            beat = asyncio.create_task(self._keep_beating())
        try:
            yield
        finally:
            if beat:
                beat.cancel()

    async def take_controls(self, token: str = "") -> None:
        """Takes the controls and holds them by a heartbeat until release_controls() or the end of the connection."""
        await self.order("TakeControls", token=token)
        self._beat_stops()
        self._beat = asyncio.create_task(self._keep_beating())

    async def release_controls(self) -> None:
        self._beat_stops()
        await self.order("ReleaseControls")

    async def arm(self, endings_seen: int | None = None, basis_seen: int | None = None) -> None:
        """Starts rendering. @param endings_seen, basis_seen of the state that was shown to the person at the request;
        None: the newest"""
        if endings_seen is None or basis_seen is None:
            state = await self._answered("Arm, which waits for a state", self._wait(lambda: self.state), None)
            endings_seen = state.endings if endings_seen is None else endings_seen
            basis_seen = state.basis if basis_seen is None else basis_seen
        await self.order("Arm", endings_seen=endings_seen, basis_seen=basis_seen)

    async def stop(self) -> None:
        await self.order("Stop")

    async def emergency_stop(self) -> None:
        """Sends an emergency stop until it is answered. Any client may. Raises Lost, Unanswered."""
        await self._answered("EmergencyStop", self._repeat_stop(), None)

    async def next_state(self) -> Table:
        """Waits for the next WorldState."""
        before = self.state
        return await self._wait(lambda: self.state if self.state is not before else None)

    def joints_now(self) -> Reals | None:
        """Predicted joint positions; None before the first state: wholehand.prediction."""
        return self._motion.joints(time.monotonic_ns())

    async def events(self) -> typing.AsyncIterator[tuple[str, typing.Any]]:
        """Iterates over (name, event) of all events from now on; `event` has tick, type, index and value. The name is
        empty for a type that the scene does not have."""
        queue: asyncio.Queue[typing.Any] = asyncio.Queue()
        self._event_queues.add(queue)
        try:
            while True:
                event = await queue.get()
                if self._lost and event is None:
                    raise self._lost
                names = self.scene.event_names if self.scene else []
                yield names[event["type"]] if event["type"] < len(names) else "", event
        finally:
            self._event_queues.discard(queue)

    async def prepare_shapes(self, shape_set: int, *shapes: make.Shape) -> None:
        """Defines shapes of later bodies, in a frame whose axes are the body's. They last for the session."""
        await self.order("PrepareShapes", set=shape_set, pieces=make.pieces(shapes))

    async def spawn(self, *bodies: make.Body) -> None:
        """@param bodies wholehand.bodies.Body, ...; their `slot` is a slot, or a number from 1000 on for a body beyond
        the slots; all other orders name the body by that number, too"""
        await self.order("Spawn", bodies=make.spawned(bodies))

    async def remove(self, *bodies: make.Name) -> None:
        """@param bodies (slot, generation), ..."""
        await self.order("Remove", bodies=make.named("Remove", bodies))

    async def teleport(self, *bodies: make.Place) -> None:
        """@param bodies (slot, generation, position_m[, orientation_xyzw]), ..."""
        await self.order("Teleport", bodies=make.placed("Teleport", bodies))

    async def set_owner(self, *bodies: make.Handover) -> None:
        """@param bodies (slot, generation, owner), ..."""
        await self.order("SetOwner", bodies=make.handed_over("SetOwner", bodies))

    async def body_targets(self, *bodies: make.Place) -> None:
        """Target poses of bodies of owner GAME; a body whose target is older than 0.1 s halts.
        @param bodies (slot, generation, position_m[, orientation_xyzw]), ..."""
        await self.order("BodyTargets", bodies=make.placed("BodyTargets", bodies))

    async def next_body_event(self) -> make.BodyEvent:
        """The next wholehand.bodies.BodyEvent; events since the begin of the connection are queued."""
        await self._wait(lambda: self._body_events)
        return self._body_events.popleft()

    def _keep_body_events(self, events: typing.Any) -> None:
        for event in events:
            name = self._event_names[event["type"]] if event["type"] < len(self._event_names) else ""
            if name in make.EVENTS:
                self._body_events.append(make.event_of(name, event, BODY_REFUSALS, self._generations, self._names))
            if name == "appeared":
                self._generations[int(event["index"])] = int(event["value"])

    async def _answered(self, what: str, asked: typing.Coroutine[typing.Any, typing.Any, Answer],
                        timeout_s: float | None) -> Answer:
        within_s = timeout_s if timeout_s is not None else self._answer_within_s
        try:
            return await asyncio.wait_for(asked, within_s)
        except asyncio.TimeoutError as error:
            raise Unanswered(what, within_s) from error

    async def _ask(self, order: str, fields: dict[str, typing.Any]) -> None:
        check_finite(order, fields)
        if order not in ("Stop", "EmergencyStop"):  # the program always reads these
            await self._take_turn()
        number, answer = await self._send(order, fields)
        try:
            reply = await answer
        finally:
            self._replies.pop(number, None)
        if not reply.accepted:
            raise Refused(order, reply)

    async def _repeat_stop(self) -> None:
        number = None
        while True:
            number, answer = await self._send("EmergencyStop", {}, number)
            try:
                await asyncio.wait_for(answer, REPEAT_STOP_S)
                return
            except asyncio.TimeoutError:
                continue
            finally:
                self._replies.pop(number, None)

    async def _take_turn(self) -> None:
        """Waits while more messages were sent than the program reads."""
        now_s = time.monotonic()
        self._allowance = min(AT_ONCE, self._allowance + MESSAGES_A_SECOND * (now_s - self._allowed_s)) - 1.0
        self._allowed_s = now_s
        if self._allowance < 0.0:
            await asyncio.sleep(-self._allowance / MESSAGES_A_SECOND)

    async def _send(self, order: str, fields: dict[str, typing.Any],
                    number: int | None = None) -> tuple[int, asyncio.Future[Table]]:
        if self._lost:
            raise self._lost
        if number is None:  # otherwise the same order is repeated
            self._number += 1
            number = self._number
        message = encode(number, order, **fields)
        answer: asyncio.Future[Table] = asyncio.get_running_loop().create_future()
        self._replies[number] = answer
        try:
            await self._socket.send(message)
        except ConnectionClosed as error:
            self._replies.pop(number)
            raise self._ended(error) from error
        return number, answer

    async def _keep_beating(self) -> None:
        while not self._lost:
            if not self.silence():
                with contextlib.suppress(ConnectionClosed):
                    await self._socket.send(encode(0, "Heartbeat"))
            await asyncio.sleep(HEARTBEAT_S)

    def _beat_stops(self) -> None:
        if self._beat:
            self._beat.cancel()
            self._beat = None

    async def _wait(self, found: typing.Callable[[], Answer | None]) -> Answer:
        """Waits until `found` returns something, and returns it."""
        while True:
            if what := found():
                return what
            if self._lost:
                raise self._lost
            self._news.clear()
            await self._news.wait()

    async def _listen(self) -> None:
        try:
            async for data in self._socket:
                self._hear(decode(data))
                self._news.set()
            self._ended("it was closed")
        except (WebSocketException, OSError, MessageError) as error:
            self._ended(error)

    def _hear(self, message: Table) -> None:
        names = {"WorldState": "state", "Scene": "scene", "Welcome": "welcome", "Controls": "controls",
                 "Commissioning": "commissioning", "GameBodies": "bodies"}
        if message.kind in names:
            setattr(self, names[message.kind], message)
            if message.kind == "WorldState":
                self._motion.add(message, time.monotonic_ns())
            if message.kind == "Scene":
                self._event_names = message.event_names if message.budget else []
            if message.kind == "GameBodies":
                for body in message.registered.copy():
                    self.registered[int(body["number"])] = body
                    if WHEREABOUTS.get(int(body["whereabouts"])) == "Gone":
                        del self.registered[int(body["number"])]
                numbers = self._numbers_in_slots()
                for body in message.bodies:
                    self._generations[int(body["slot"])] = int(body["generation"])
                    if int(body["slot"]) not in numbers:
                        self._names.pop(int(body["slot"]), None)
                self._names.update((slot, (number, int(self.registered[number]["generation"])))
                                   for slot, number in numbers.items())
        elif message.kind == "Reply":
            answer = self._replies.get(message.command)
            if answer and not answer.done():
                answer.set_result(message)
        elif message.kind == "Events":
            self._keep_body_events(message.events)
            for queue in self._event_queues:
                for event in message.events:
                    queue.put_nowait(event)

    def _numbers_in_slots(self) -> dict[int, int]:
        return {int(body["slot"]): number for number, body in self.registered.items() if body["slot"] >= 0}

    def body_poses(self) -> dict[int, typing.Any]:
        """Poses of a game's bodies: the schema's Pose by slot, or by number. A body in a slot has the newest
        state's."""
        poses = {number: body["pose"] for number, body in self.registered.items()}
        state, reported = self.state, self.bodies
        if self.scene is None or reported is None or state is None or state.session != reported.session:
            return poses
        numbers, in_state = self._numbers_in_slots(), state.bodies[len(self.scene.bodies):]
        for slot in map(int, reported.bodies["slot"]):
            if slot < len(in_state) and in_state["position_m"][slot, 2] > EMPTY_BELOW_M:
                poses[numbers.get(slot, slot)] = in_state[slot]
        return poses

    def _ended(self, why: typing.Any) -> Lost:
        """Ends all waiting calls, since the connection is lost."""
        if self._lost is None:
            self._lost = Lost(f"the connection to the program ended: {why}")
        for answer in self._replies.values():
            if not answer.done():
                answer.set_exception(self._lost)
        for queue in self._event_queues:
            queue.put_nowait(None)
        self._beat_stops()
        self._news.set()
        return self._lost
