"""Rules of packed recordings that learn from the earlier rows of a chunk, of schema 6 and 7 (docs/recording.md)."""
import numpy

from wholehand.packing import extrapolated


class Oscillation:
    """A sine on a straight line: second differences obey d = r d1 - d2, r by least squares over the chunk."""

    def __init__(self, values):
        self.values = values
        self.products = self.squares = numpy.zeros(values[:, 0].shape)

    def __call__(self, row):
        values = self.values
        if row < 5:
            return extrapolated(values, row, 5)
        last, before, first = (self._bend(row - back) for back in (1, 2, 3))
        product, square = before * (last + first), before * before
        learnt = numpy.isfinite(product) & numpy.isfinite(square)
        self.products = numpy.where(learnt, self.products + product, self.products)
        self.squares = numpy.where(learnt, self.squares + square, self.squares)
        rate = numpy.where(self.squares > 0.0, self.products / self.squares, 2.0)
        value = values[:, row - 1]
        following = value + ((value - values[:, row - 2]) + (rate * last - before))
        return numpy.where(numpy.isfinite(following), following, value)

    def _bend(self, row):
        middle = self.values[:, row - 1]
        return (self.values[:, row] - middle) - (middle - self.values[:, row - 2])


class CriticallyDampedEffort:
    """Eq. (2) with a damping that is a parabola, by the last three rows, over the position of one axis or of none."""

    CHOICE_ROWS, FIRST_CHOICE, JUDGED_ROWS = 25, 8, 4

    def __init__(self, recording, values):
        self.values, self.recording, self.k_pm = values, recording, recording.meta["k_pm"]
        self.q_s = recording._block("q_s")
        self.axes = values.shape[2]
        self.source = numpy.tile(numpy.arange(self.axes), (len(values), 1))  # self.axes: none

    def __call__(self, row):
        if row % self.CHOICE_ROWS == self.FIRST_CHOICE:
            self.source = self._best_sources(row)
        damping = 0.0
        if row > 0:
            damping = self._damping(row - 1) if row < 3 else self._expected(row, self.source)
        return self.k_pm * self.recording._stretch(row) + damping * self.recording._rate(row)

    def _damping(self, row):
        return quotient(self.values[:, row] - self.k_pm * self.recording._stretch(row), self.recording._rate(row))

    def _expected(self, row, source):
        d1, d2, d3 = (self._damping(row - back) for back in (1, 2, 3))
        taken = numpy.minimum(source, self.axes - 1)
        x, x1, x2, x3 = (numpy.take_along_axis(self.q_s[:, row - back], taken, 1) for back in range(4))
        slope = quotient(d1 - d2, x1 - x2)
        curve = quotient(slope - quotient(d2 - d3, x2 - x3), x1 - x3)
        return numpy.where(source == self.axes, d1, (d1 + slope * (x - x1)) + (curve * (x - x1)) * (x - x2))

    def _best_sources(self, row):
        best = numpy.full(self.source.shape, self.axes)
        least = self._judged(row, best)
        for axis in range(self.axes):
            error = self._judged(row, numpy.full(self.source.shape, axis))
            best, least = numpy.where(error < least, axis, best), numpy.where(error < least, error, least)
        return best

    def _judged(self, row, source):
        error = 0.0
        for back in range(1, self.JUDGED_ROWS + 1):
            error = error + abs(self._damping(row - back) - self._expected(row - back, source))
        return error


def quotient(a, b):
    return numpy.where(b != 0.0, a / b, 0.0)
