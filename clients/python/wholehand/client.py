"""A connection to a running program, without asyncio: docs/protocol.md.

    with Client("127.0.0.1:8080", role="therapist") as program:
        program.take_controls()
        program.arm()
        state = program.next_state()
"""
from __future__ import annotations

import asyncio
import threading
import time
import types
import typing

from wholehand.bodies import Body, BodyEvent, Handover, Name, Place, Shape
from wholehand.connection import ANSWER_WITHIN_S, Connection, Lost, connect
from wholehand.messages import Reals, Table

# A thread that holds the controls and makes no call for this long counts as hung: the heartbeat ends, and the
# program takes the controls back. The pages have the same rule.
HUNG_AFTER_S = 3.0

Answer = typing.TypeVar("Answer")


class Client:
    """Runs a Connection in a thread of its own. All methods are called from one thread; every call shows that the
    caller is alive."""

    def __init__(self, address: str = "127.0.0.1:8080", role: str | None = None, token: str | None = None,
                 answer_within_s: float = ANSWER_WITHIN_S) -> None:
        """Has the arguments of wholehand.connection.connect()."""
        self._loop = asyncio.new_event_loop()
        self._thread = threading.Thread(target=self._loop.run_forever, daemon=True)
        self._thread.start()
        self._open = connect(address, role, token, answer_within_s)
        self._in_call, self._called_s = False, time.monotonic()
        try:
            self._program: Connection = self._call(self._open.__aenter__())
        except BaseException:
            self._end_thread()
            raise
        self._program.silence = lambda: not self._in_call and time.monotonic() - self._called_s > HUNG_AFTER_S

    def __enter__(self) -> Client:
        return self

    def __exit__(self, *_: type[BaseException] | BaseException | types.TracebackType | None) -> None:
        self.close()

    @property
    def scene(self) -> Table | None:
        return self._program.scene

    @property
    def state(self) -> Table | None:
        """The newest state; None before the first one."""
        return self._program.state

    @property
    def controls(self) -> Table | None:
        return self._program.controls

    @property
    def welcome(self) -> Table | None:
        return self._program.welcome

    def order(self, order: str, timeout_s: float | None = None, **fields: typing.Any) -> None:
        """Sends one of the schema's Order and waits for the answer. Raises Refused, Lost, Unanswered, and
        ValueError for invalid arguments, such as a number that is not finite.
        @param timeout_s replaces the client's answer_within_s"""
        self._call(self._program.order(order, timeout_s, **fields))

    def take_controls(self, token: str = "") -> None:
        self._call(self._program.take_controls(token))

    def release_controls(self) -> None:
        self._call(self._program.release_controls())

    def arm(self, endings_seen: int | None = None, basis_seen: int | None = None) -> None:
        self._call(self._program.arm(endings_seen, basis_seen))

    def stop(self) -> None:
        self._call(self._program.stop())

    def emergency_stop(self) -> None:
        self._call(self._program.emergency_stop())

    def next_state(self, timeout_s: float | None = None) -> Table:
        """Waits for the next WorldState."""
        return self._call(self._program.next_state(), timeout_s)

    def joints_now(self) -> Reals | None:
        """Predicted joint positions; None before the first state: wholehand.prediction."""
        async def ask() -> Reals | None:
            return self._program.joints_now()
        return self._call(ask())

    @property
    def bodies(self) -> Table | None:
        """The schema's GameBodies; None before the first one."""
        return self._program.bodies

    @property
    def registered(self) -> dict[int, typing.Any]:
        """Bodies beyond the slots: the schema's RegisteredBody by number."""
        return self._program.registered

    def body_poses(self) -> dict[int, typing.Any]:
        """Poses of a game's bodies: the schema's Pose by slot, or by number."""
        async def ask() -> dict[int, typing.Any]:
            return self._program.body_poses()
        return self._call(ask())

    def prepare_shapes(self, shape_set: int, *shapes: Shape) -> None:
        self._call(self._program.prepare_shapes(shape_set, *shapes))

    def spawn(self, *bodies: Body) -> None:
        self._call(self._program.spawn(*bodies))

    def remove(self, *bodies: Name) -> None:
        self._call(self._program.remove(*bodies))

    def teleport(self, *bodies: Place) -> None:
        self._call(self._program.teleport(*bodies))

    def set_owner(self, *bodies: Handover) -> None:
        self._call(self._program.set_owner(*bodies))

    def body_targets(self, *bodies: Place) -> None:
        self._call(self._program.body_targets(*bodies))

    def next_body_event(self, timeout_s: float | None = None) -> BodyEvent:
        return self._call(self._program.next_body_event(), timeout_s)

    def close(self) -> None:
        if self._thread.is_alive():
            self._call(self._open.__aexit__(None, None, None))
            self._end_thread()

    def _call(self, coroutine: typing.Coroutine[typing.Any, typing.Any, Answer], timeout_s: float | None = None) -> Answer:
        if not self._thread.is_alive():
            coroutine.close()
            raise Lost("this client is closed")
        self._in_call = True
        asked = asyncio.run_coroutine_threadsafe(coroutine, self._loop)
        try:
            return asked.result(timeout_s)
        finally:
            asked.cancel()
            self._in_call, self._called_s = False, time.monotonic()

    def _end_thread(self) -> None:
        self._loop.call_soon_threadsafe(self._loop.stop)
        self._thread.join()
        self._loop.close()
