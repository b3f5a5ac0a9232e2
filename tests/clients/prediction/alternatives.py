"""Other ways to predict a motion, for figures beside those of the clients' own (test_prediction.py)."""
import collections

import numpy

from wholehand.prediction import MotionPredictor

MOST = 40  # states that are kept


class Alternative:
    """A way `ahead(times_s, joints, age_s)`, with the clock of the clients' predictor; the newest state is the last."""

    def __init__(self, ahead):
        self._ahead, self._clock, self._times = ahead, MotionPredictor(), collections.deque(maxlen=MOST)
        self._joints = collections.deque(maxlen=MOST)

    def add_joints(self, session, time_s, sent_ns, received_ns, joints):
        self._clock.add_joints(session, time_s, sent_ns, received_ns, joints)
        self._times.append(time_s)
        self._joints.append(joints)

    def joints(self, now_ns):
        return self._ahead(numpy.array(self._times), numpy.array(self._joints), self._clock.age_s(now_ns))


def slope(times, joints, apart_s):
    """By the newest state and the newest one that is so much older."""
    before = max(0, numpy.searchsorted(times, times[-1] - apart_s, "right") - 1)
    before = min(before, len(times) - 2)
    return (joints[-1] - joints[before]) / (times[-1] - times[before]) if len(times) > 1 else 0.0 * joints[-1]


def line(times, joints, age_s):
    return joints[-1] + slope(times, joints, 0.0) * age_s


def damped(times, joints, age_s, fades_s=0.03):
    return joints[-1] + slope(times, joints, 0.0) * fades_s * (1.0 - numpy.exp(-age_s / fades_s))


def limited(times, joints, age_s, horizon_s=0.015):
    return joints[-1] + slope(times, joints, 0.0) * min(age_s, horizon_s)


def whole_parabola(times, joints, age_s, window_s=0.03):
    """Least squares of the states of the last 30 ms, through the newest."""
    first = min(numpy.searchsorted(times, times[-1] - window_s), max(0, len(times) - 3))
    s = (times[first:-1] - times[-1]) / window_s
    if len(s) < 2:
        return line(times, joints, age_s)
    powers = numpy.linalg.lstsq(numpy.stack([s, s * s], 1), joints[first:-1] - joints[-1], rcond=None)[0]
    g = age_s / window_s
    return joints[-1] + numpy.array([g, g * g]) @ powers


def interpolated(times, joints, age_s, delay_s=0.02):
    """Drawn one jitter late, between states."""
    at = times[-1] + age_s - delay_s
    return numpy.array([numpy.interp(at, times, column) for column in joints.T])


def alpha_beta(times, joints, age_s, alpha=0.8, beta=0.4):
    first = max(0, len(times) - 30)
    at, speed = joints[first], 0.0 * joints[first]
    for i in range(first + 1, len(times)):
        step = times[i] - times[i - 1]
        off = joints[i] - at - speed * step
        at, speed = at + speed * step + alpha * off, speed + beta / step * off
    return at + speed * age_s


ALL = {"line through two": line, "line, fading within 30 ms": damped, "line, 15 ms at most": limited,
       "parabola by least squares": whole_parabola, "20 ms late, interpolated": interpolated, "alpha-beta filter": alpha_beta}
