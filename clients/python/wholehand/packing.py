"""Rules of packed recordings since schema 8, a second time beside those in C++ (src/telemetry): grids, and the laws of
the avatar, the wall, the damping and the tank (docs/recording.md, "Packed datasets"). Operations are in the order of the
file format. Arrays have a row for each chunk of the recording.
"""
import numpy

STEP_CODES = 2**32  # codes below count steps of a grid
# Orders of the polynomials from which steps are counted, and the steps; of q_m those of the encoder.
STEP_POLYNOMIALS = {"q_m": 2, "intention": 3, "patient_effort": 4, "closure": 3, "palm_distance_m": 3,
                    "exercise_values": 3}
STEPS = {"intention": 2.0**-20, "patient_effort": 2.0**-24, "closure": 2.0**-24, "palm_distance_m": 2.0**-24}


def steps_of(column, meta):
    """Step of each number of a row, 0 without a grid."""
    if column == "q_m":
        return meta["encoder_step"]
    if column != "exercise_values":
        return numpy.float64(STEPS[column])
    return meta["value_steps"] if len(meta["value_steps"]) else numpy.zeros(len(meta["value_names"]))


def folded(difference):
    return (difference << numpy.uint64(1)) ^ (numpy.uint64(0) - (difference >> numpy.uint64(63)))


def unfolded(number):
    return (number >> numpy.uint64(1)) ^ (numpy.uint64(0) - (number & numpy.uint64(1)))


def unpacked_steps(code, expected_bits, step):
    """Bits of numbers on a grid, or beside it."""
    at = numpy.rint(expected_bits.view(numpy.float64) / step)
    usable = (step >= 2.0**-200) & (step <= 2.0**200) & (abs(at) <= 2.0**50)
    at = numpy.where(usable, at, 0.0).astype(numpy.int64)

    def bits_at(k):
        return (k.astype(numpy.float64) * step).view(numpy.uint64)

    counts = usable & (code < STEP_CODES)
    steps = unfolded(numpy.where(counts, code, numpy.uint64(0))).view(numpy.int64)
    code = numpy.where(counts, folded(bits_at(at + steps) - expected_bits), code)
    beside = usable & ~counts
    while beside.any():  # the code of a number beside the grid, taken by a grid point
        bits = unfolded(code) + expected_bits
        k = numpy.rint(bits.view(numpy.float64) / step)
        away = k - at.astype(numpy.float64)
        near = beside & (away >= -2.0**31) & (away < 2.0**31)
        whole = numpy.where(near, k, 0.0).astype(numpy.int64)
        beside = near & (bits_at(whole) == bits)
        code = numpy.where(beside, folded((whole - at).view(numpy.uint64)), code)
    return unfolded(code) + expected_bits


class PostureInertia:
    """M_r as a sum of terms: products of Chebyshev polynomials of the axes, times a lower triangle."""

    def __init__(self, rows, lower, upper):
        self.axes = len(lower)
        self.degrees, coefficients = rows[:, :self.axes].astype(int), rows[:, self.axes:]
        self.size = coefficients.shape[1]
        self.terms = [(degrees, numpy.nonzero(row)[0], row[row != 0.0])
                      for degrees, row in zip(self.degrees, coefficients)]
        self.middle, self.range = lower + upper, upper - lower

    def at(self, q_s):
        x = numpy.where(self.range != 0.0, ((q_s + q_s) - self.middle) / self.range, 0.0)
        chebyshev = [numpy.ones(x.shape), x]
        for _ in range(2, self.degrees.max(initial=1) + 1):
            chebyshev.append(2.0 * x * chebyshev[-1] - chebyshev[-2])
        matrix = numpy.zeros((len(q_s), self.size))
        for degrees, places, coefficients in self.terms:
            product = numpy.ones(len(q_s))
            for axis in numpy.nonzero(degrees)[0]:
                product = product * chebyshev[degrees[axis]][:, axis]
            matrix[:, places] += product[:, None] * coefficients
        return matrix

    def solve(self, matrix, f, given=()):
        """a of M_r a = f behind the first numbers, which are given; by L D Lᵀ of the block behind them."""
        n, known = self.axes, len(given)
        m = {(i, j): matrix[:, i * (i + 1) // 2 + j] for i in range(n) for j in range(i + 1)}
        for j in range(known, n):
            for i in range(j, n):
                for k in range(known, j):
                    m[i, j] = m[i, j] - m[i, k] * m[j, k] * m[k, k]
                if i > j:
                    m[i, j] = m[i, j] / m[j, j]
        a = [*given, *(f[:, i] for i in range(known, n))]
        for i in range(known, n):
            for k in range(i):
                a[i] = a[i] - m[i, k] * a[k]
        for i in range(known, n):
            a[i] = a[i] / m[i, i]
        for i in reversed(range(known, n)):
            for k in range(i + 1, n):
                a[i] = a[i] - m[k, i] * a[k]
        return numpy.stack(a[known:], 1)


class SteppedVelocity:
    """The step without contacts; the hand axes' after contacts; or a polynomial, where that was nearer.

    Called, it expects the base axes of a row, and all axes of a row without contacts; behind(), the hand axes.
    """

    def __init__(self, at, inertia, meta, polynomial):
        self.at, self.inertia, self.period_s, self.polynomial_at = at, inertia, meta["period_s"], polynomial
        hand = meta["hand_axis"] != 0.0
        first = int(numpy.argmax(hand)) if hand.any() else len(hand)
        self.base_axes = first if hand[first:].all() and len(hand) else inertia.axes
        self.later = (numpy.arange(inertia.axes) >= self.base_axes) & (self.base_axes > 0)

    def __call__(self, row):
        polynomial = self.polynomial_at(row)
        if row == 0:
            self.by_law = numpy.ones((2, *polynomial.shape), bool)  # without and with contacts
            self.law = self.polynomial = polynomial
            return polynomial
        if row > 1:
            v = self.at("qd_s")[:, row - 1]
            judged = abs(v - self.law) <= abs(v - self.polynomial)
            hand = numpy.arange(self.inertia.axes) >= self.base_axes
            self.by_law[0] = numpy.where(self.touches, self.by_law[0], judged)
            self.by_law[1] = numpy.where(self.touches & hand, judged, self.by_law[1])
        self.polynomial = polynomial
        self.touches = self.at("contact_count")[:, row - 1] != 0
        self.matrix = self.inertia.at(self.at("q_s")[:, row - 1])
        self.law = self._stepped(row)
        if self.base_axes == 0:
            return self._chosen(numpy.where(self.touches, self.by_law[1], self.by_law[0]))
        return self._chosen(self.by_law[0] & ~self.touches)

    def behind(self, row):
        if row == 0:
            return self.polynomial
        v = self.at("qd_s")
        given = (v[:, row, :self.base_axes] - v[:, row - 1, :self.base_axes]) / self.period_s
        hand = self._stepped(row, [given[:, i] for i in range(self.base_axes)])
        self.law[:, self.base_axes:] = numpy.where(self.touches, hand, self.law[:, self.base_axes:])
        return self._chosen(numpy.where(self.touches, self.by_law[1], self.by_law[0]))

    def _stepped(self, row, given=()):
        before = self.at("qd_s")[:, row - 1, len(given):]
        return before + self.period_s * self.inertia.solve(self.matrix, self.at("f_s")[:, row - 1], given)

    def _chosen(self, by_law):
        return numpy.where(by_law & numpy.isfinite(self.law), self.law, self.polynomial)


class BodyMotion:
    """Bodies move on with the velocities of their row, which are polynomials. behind(): positions and orientations."""

    def __init__(self, values, period_s):
        self.values, self.period_s = values, period_s
        self.later = numpy.arange(values.shape[2]) % 13 < 7

    def __call__(self, row):
        self.expected = extrapolated(self.values, row, 5)
        return self.expected

    def behind(self, row):
        if row == 0:
            return numpy.zeros(self.values[:, 0].shape)
        shape = (len(self.values), -1, 13)
        before, now = self.values[:, row - 1].reshape(shape), self.values[:, row].reshape(shape)
        expected = self.expected.reshape(shape).copy()
        expected[..., :3] = before[..., :3] + self.period_s * now[..., 7:10]
        expected[..., 3:7] = self._turned(before[..., 3:7], now[..., 10:])
        return expected.reshape(self.expected.shape)

    def _turned(self, q, v):
        s = ((v[..., 0] * v[..., 0] + v[..., 1] * v[..., 1]) + v[..., 2] * v[..., 2]) * (
            0.25 * self.period_s * self.period_s)  # half the angle, squared
        sine = 0.5 * self.period_s * (1.0 - s / 6.0 * (1.0 - s / 20.0 * (1.0 - s / 42.0)))
        c = 1.0 - s / 2.0 * (1.0 - s / 12.0 * (1.0 - s / 30.0))
        (x, y, z), (a, b, d, e) = (v[..., k] * sine for k in range(3)), (q[..., k] for k in range(4))
        turned = [((c * a + x * e) + y * d) - z * b, ((c * b + y * e) + z * a) - x * d,
                  ((c * d + z * e) + x * b) - y * a, ((c * e - x * a) - y * b) - z * d]
        length = numpy.sqrt(((turned[0] * turned[0] + turned[1] * turned[1]) + turned[2] * turned[2])
                            + turned[3] * turned[3])
        rests = (v == 0.0).all(-1, keepdims=True)
        return numpy.where(rests, q, numpy.stack(turned, -1) / length[..., None])


def inertial_effort(at, inertia, k_pm, period_s, row):
    """Eq. (2) with the critical damping of the axis's own inertia."""
    matrix = inertia.at(at("q_s")[:, row])
    mass = matrix[:, [i * (i + 3) // 2 for i in range(inertia.axes)]]
    k = k_pm / mass
    damping = mass * (2.0 * numpy.sqrt(k) - k * period_s)
    return k_pm * (at("q_m")[:, row] - at("q_s")[:, row]) + damping * (at("qd_mf")[:, row] - at("qd_s")[:, row])


def wall_position(at, values, row):
    """A wall stays, or moves as the first touch: as it did better in the row before."""
    if row < 2:
        return values[:, row - 1] if row > 0 else 0.0

    def moved(row):
        return at("closure")[:, row] - (at("closure")[:, row - 1] - values[:, row - 1])

    last, now = values[:, row - 1], moved(row)
    moves = abs(last - moved(row - 1)) < abs(last - values[:, row - 2])
    return numpy.where(moves & numpy.isfinite(now), now, last)


def wall_effort(at, values, row):
    """α (k p + d q̇_mf), k and d from the last two rows."""
    if row < 2:
        return values[:, row - 1] if row > 0 else 0.0
    p, p1, p2 = (at("q_m")[:, row - back] - at("wall")[:, row - back] for back in range(3))
    v1, v2 = at("qd_mf")[:, row - 1], at("qd_mf")[:, row - 2]
    push1, push2 = (-values[:, row - back] / at("alpha")[:, row - back] for back in (1, 2))
    determinant = p1 * v2 - p2 * v1
    k, d = (push1 * v2 - push2 * v1) / determinant, (p1 * push2 - p2 * push1) / determinant
    alpha, now = at("alpha")[:, row], k * p + d * at("qd_mf")[:, row]
    pushes = (at("wall_active")[:, row] == 1.0) & (p > 0.0) & (now > 0.0)
    return numpy.where(pushes, -numpy.where(alpha < 1.0, alpha, 1.0) * now, 0.0)


class ActivatedDamping:
    """Φ by Algorithm 1 and Eq. (5)."""

    def __init__(self, at, meta, values):
        self.at, self.meta, self.values = at, meta, values
        self.hand = meta["hand_axis"] != 0.0

    def __call__(self, row):
        kept = 0.0
        if row > 0:
            before = self.values[:, row - 1]
            known = self.hand | (not self.hand.any()) | (before != self._largest(before))
            kept = self.meta["phi_kept"] * numpy.where(known, before, self.own)
        now = self._activation(row)
        self.own = numpy.where(kept > now, kept, now)
        hand = self._largest(self.own)
        base = numpy.where((self.meta["palm_contact"] != 0.0) & (self.own > hand), self.own, hand)
        return numpy.where(self.hand | (not self.hand.any()), self.own, base)

    def _largest(self, numbers):
        most = numpy.zeros((len(numbers), 1))
        for axis in numpy.nonzero(self.hand)[0]:
            most = numpy.where(numbers[:, [axis]] > most, numbers[:, [axis]], most)
        return most

    def _activation(self, row):
        dead, full = self.meta["effort_dead"], self.meta["effort_full"]
        effort = abs(self.at("coupling")[:, row] + self.at("exercise_effort")[:, row])
        share = (effort - dead) / (full - dead)
        share = numpy.where(share < 0.0, 0.0, numpy.where(share > 1.0, 1.0, share))
        return numpy.where(full > dead, share, numpy.where(effort <= dead, 0.0, 1.0))


class DissipatedEnergy:
    """What the device's own damping takes in a row, by a speed behind a low-pass that begins in the first row."""

    FILTER_S = 2e-3

    def __init__(self, at, meta):
        self.at, self.meta = at, meta

    def __call__(self, row):
        if row == 0:
            self.speed = self.at("qd_mf")[:, 0]
            return 0.0
        elapsed_s = self.at("elapsed_periods")[:, row] * self.meta["period_s"]
        moved = self.at("q_m")[:, row] - self.at("q_m")[:, row - 1]
        self.speed = (self.FILTER_S * self.speed + moved) / (self.FILTER_S + elapsed_s)
        return self.meta["device_damping"] * self.speed * self.speed * elapsed_s


def wall_stored(at, row):
    """Energy in the exercise's walls."""
    depth = at("q_m")[:, row] - at("wall")[:, row]
    stored = 0.5 * abs(at("exercise_effort")[:, row] * depth)
    return numpy.where(at("wall_active")[:, row] == 1.0, stored, 0.0)


def extrapolated(values, row, order):
    """The polynomial through the last `order` rows, by its differences."""
    difference = [values[:, row - 1 - k] for k in range(min(row, order))]
    if not difference:
        return numpy.zeros(values[:, 0].shape)
    last = following = difference[0]
    while len(difference) > 1:
        difference = [a - b for a, b in zip(difference, difference[1:])]
        following = following + difference[0]
    return numpy.where(numpy.isfinite(following), following, last)


def decayed(values, row):
    """The last row, smaller by as much as it was than the one before."""
    if row == 0:
        return numpy.zeros(values[:, 0].shape)
    last = values[:, row - 1]
    if row == 1:
        return last
    before = values[:, row - 2]
    return numpy.where((last == 0.0) | (before == 0.0), last, last * (last / before))
