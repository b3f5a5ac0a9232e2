"""Predicts the hand's joints at present from states that come late, irregularly and with losses."""
from __future__ import annotations

import numpy

from wholehand.messages import Reals, Table

SPACING_S = 0.0045         # minimum spacing between the states of a parabola
CURVATURE_SHARE = 0.75
LONGEST_S = 0.05           # maximum extrapolation beyond the newest state
FADES_FROM_S, FADED_AT_S = 0.1, 0.25  # without a new state the hand returns to the newest one between these ages
DELAY_WINDOW_NS = 2_000_000_000       # the minimum delay is taken over one to two windows
KEPT = 4


class MotionPredictor:
    """A parabola through the newest state and two earlier ones. Its curvature is weighted by three quarters, which
    halves the overshoot at the end of a motion. The age of a state is relative to the fastest delivery of the last
    seconds: the clocks of program and client may differ, and the delay of the fastest delivery is not compensated."""

    def __init__(self) -> None:
        self._kept: list[tuple[float, Reals]] = []  # (time_s, joints), newest first; spaced by SPACING_S at least
        self._session = self._newest_sent_ns = 0
        self._delay_ns = self._delay_before_ns = self._window_ends_ns = 0

    def add(self, state: Table, received_ns: int) -> None:
        """@param state WorldState @param received_ns time.monotonic_ns() when it came"""
        joints = numpy.array(state.theta, float)
        if len(joints):
            self.add_joints(state.session, state.time_s, state.sent_monotonic_ns, received_ns, joints)

    def add_joints(self, session: int, time_s: float, sent_ns: int, received_ns: int, joints: Reals) -> None:
        """Like add(). Older states are ignored."""
        kept = self._kept
        same = bool(kept) and session == self._session and len(joints) == len(kept[0][1])
        if same and (sent_ns <= self._newest_sent_ns or time_s == kept[0][0]):
            return
        continues = same and time_s > kept[0][0]
        self._count_delay(received_ns - sent_ns, received_ns)
        if not continues:
            kept.clear()
        self._session, self._newest_sent_ns = session, sent_ns
        # The newest sample is kept if it is far enough from the next one; otherwise it is replaced.
        if len(kept) > 1 and kept[0][0] - kept[1][0] < SPACING_S:
            kept.pop(0)
        kept.insert(0, (time_s, joints))
        del kept[KEPT:]

    def joints(self, now_ns: int) -> Reals | None:
        """The joints at `now_ns` of time.monotonic_ns(); None before the first state."""
        kept = self._kept
        if not kept:
            return None
        age_s = self.age_s(now_ns)
        fading = min(1.0, max(0.0, (FADED_AT_S - age_s) / (FADED_AT_S - FADES_FROM_S)))
        ahead_s = fading * min(age_s, LONGEST_S)
        near = len(kept) > 1 and kept[0][0] - kept[1][0] < SPACING_S
        (newest_s, newest), *before = kept[:1] + kept[2 if near else 1:]
        if not before:
            return newest.copy()
        h = newest_s - before[0][0]
        slope = (newest - before[0][1]) / h
        ahead = slope * ahead_s
        if len(before) > 1:
            h_before = before[0][0] - before[1][0]
            curvature = (slope - (before[0][1] - before[1][1]) / h_before) / (h + h_before)
            ahead += CURVATURE_SHARE * curvature * ahead_s * (ahead_s + h)
        return newest + ahead

    def age_s(self, now_ns: int) -> float:
        """The age of the newest state, without the delay of the fastest delivery."""
        return max(0.0, 1e-9 * (now_ns - self._newest_sent_ns - min(self._delay_ns, self._delay_before_ns)))

    def _count_delay(self, delay_ns: int, now_ns: int) -> None:
        """Keeps the minimum of this window and of the one before it."""
        if not self._kept:
            self._delay_ns = self._delay_before_ns = delay_ns
            self._window_ends_ns = now_ns + DELAY_WINDOW_NS
        if now_ns >= self._window_ends_ns:
            self._delay_before_ns, self._delay_ns = self._delay_ns, delay_ns
            self._window_ends_ns = now_ns + DELAY_WINDOW_NS
        self._delay_ns = min(self._delay_ns, delay_ns)
