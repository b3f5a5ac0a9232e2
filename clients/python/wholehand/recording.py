"""Reads recordings of Wholehand with h5py: numbers as they were recorded, to the bit.

    f = wholehand.open("run.h5")
    time_s, sent = f["ticks/time_s"][:], f["ticks/sent"][:]
    frame, data = f.to_pandas("q_m", "sent"), f.to_xarray("bodies")

From schema version 5 on, most datasets of /ticks are packed: they hold how far each number is from what
the rest of its row and the rows before it let expect (docs/recording.md, "Packed datasets"). A `Recording`
is used as the h5py file it wraps, and gives packed datasets unpacked.
"""
from collections.abc import Mapping

import h5py
import numpy

from wholehand import learning, packing, tables
from wholehand.packing import decayed, extrapolated

FIRST_PACKED_SCHEMA, ROW_ELEMENT_SCHEMA, GRID_SCHEMA, STEP_SCHEMA, LAST_SCHEMA = 5, 6, 7, 8, 8
POLYNOMIALS = {"intention": 6, "patient_effort": 5, "palm_distance_m": 5, "bodies": 1,
            "exercise_values": 1, "parameters": 1, "qd_s": 5}  # orders of the polynomials
LATER_POLYNOMIALS = {"patient_effort": 9, "palm_distance_m": 7}  # from ROW_ELEMENT_SCHEMA on
GRID_STEPS = {"intention": 2.0**20, "patient_effort": 2.0**24}  # of a unit, from GRID_SCHEMA on
# Each needs of its own row only datasets that are not packed, or stand before it.
ORDER = ("time_s", "q_m", "qd_s", "q_s", "qd_mf", "theta", "f_s", "coupling", "closure", "wall", "alpha",
         "exercise_effort", "phi", "damping", "rendered", "sent", "tank", "intention", "patient_effort",
         "palm_distance_m", "bodies", "parameters", "exercise_values", "palm_target_distance_m")
MOTION = ("qd_s", "q_s", "f_s")  # from STEP_SCHEMA on, each needs rows before of the others


class Column:
    """An unpacked dataset: sliced as one of h5py, with its attributes."""

    def __init__(self, values, attrs):
        self.values, self.attrs = values, attrs
        self.shape, self.dtype = values.shape, values.dtype

    def __getitem__(self, key):
        return self.values[key]

    def __len__(self):
        return len(self.values)

    def __array__(self, dtype=None, copy=None):
        return numpy.array(self.values, dtype=dtype)


class Ticks(Mapping):
    """The group /ticks: datasets by their names, unpacked."""

    def __init__(self, recording):
        self._recording = recording

    def __getitem__(self, name):
        return self._recording[f"ticks/{name}"]

    def __iter__(self):
        return iter(self._recording.file["ticks"])

    def __len__(self):
        return len(self._recording.file["ticks"])


class Recording:
    """A recording, opened for reading; one that is still written or was cut off, too."""

    def __init__(self, path):
        self.file = h5py.File(path, "r", libver="latest", swmr=True)
        self._raw = self.file["ticks"]
        self.ticks = Ticks(self)
        self.meta = self.file["meta"].attrs
        version = self.meta["schema_version"]
        if version > LAST_SCHEMA:  # its packed numbers would come out wrong
            self.file.close()
            raise ValueError(f"{path}: schema_version = {version}: was written by a newer Wholehand; this package reads "
                             f"versions up to {LAST_SCHEMA}: update it")
        self._blocks = {}  # name -> chunks x rows of a chunk x numbers of a row
        self._rows = min(len(self._raw[name]) for name in self._raw)

    def __enter__(self):
        return self

    def __exit__(self, *_):
        self.file.close()

    def __contains__(self, name):
        return name in self.file

    def __getitem__(self, name):
        if name.strip("/") == "ticks":
            return self.ticks
        dataset = self.file[name]
        group, _, column = name.strip("/").rpartition("/")
        if group != "ticks" or not self._is_packed(column):
            return dataset
        values = self._block(column).reshape(-1, *row_shape(dataset))
        return Column(values[:self._rows], dataset.attrs)

    def to_pandas(self, *names):
        """A DataFrame of datasets of /ticks, all where none is named: see tables.to_pandas."""
        return tables.to_pandas(self, *names)

    def to_xarray(self, *names):
        """A Dataset of datasets of /ticks, all where none is named: see tables.to_xarray."""
        return tables.to_xarray(self, *names)

    def __getattr__(self, name):  # keys, attrs, close ...
        return getattr(self.file, name)

    def _is_packed(self, column):
        packed = self.meta["schema_version"] >= FIRST_PACKED_SCHEMA
        return packed and column in ORDER and self._raw[column].dtype.base == numpy.uint64

    def _block(self, column):
        if column not in self._blocks:
            self._blocks[column] = self._unpacked(column) if self._is_packed(column) else self._plain(column)
        return self._blocks[column]

    def _plain(self, column):
        dataset = self._raw[column]
        rows = dataset.chunks[0]
        chunks = -(-self._rows // rows)
        values = numpy.zeros((chunks * rows, *row_shape(dataset)), dataset.dtype.base)
        values[:self._rows] = dataset[:self._rows]
        return values.reshape(chunks, rows, -1)

    def _unpacked(self, column):
        together = MOTION if self._inertia() is not None and column in MOTION else (column,)
        folded = {name: self._plain(name) for name in together}
        self._blocks.update({name: numpy.zeros(numbers.shape) for name, numbers in folded.items()})
        try:
            rules = {name: self._rule(name, self._blocks[name]) for name in together}
            with numpy.errstate(all="ignore"):
                for row in range(folded[column].shape[1]):
                    for name, rule in rules.items():
                        self._unpack_row(name, row, folded[name][:, row], rule)
        except BaseException:  # half unpacked numbers must not be given
            for name in together:
                del self._blocks[name]
            raise
        return self._blocks[column]

    def _unpack_row(self, column, row, code, rule):
        bits, expected = self._blocks[column].view(numpy.uint64), rule(row)
        bits[:, row] = self._bits(column, row, code, expected)
        later = getattr(rule, "later", None)  # numbers that need the others
        if later is not None and later.any():
            bits[:, row, later] = self._bits(column, row, code, rule.behind(row))[:, later]

    def _bits(self, column, row, code, expected):
        bits = self._blocks[column].view(numpy.uint64)
        expected = numpy.ascontiguousarray(numpy.broadcast_to(expected, code.shape), numpy.float64)
        before = bits[:, row - 1] if row > 0 else numpy.uint64(0)
        expected_bits = numpy.where(numpy.isnan(expected), before, expected.view(numpy.uint64))
        if self._has_steps(column):
            return packing.unpacked_steps(code, expected_bits, packing.steps_of(column, self.meta))
        return packing.unfolded(code) + expected_bits

    def _has_steps(self, column):
        return self.meta["schema_version"] >= STEP_SCHEMA and column in packing.STEP_POLYNOMIALS

    def _inertia(self):
        """Of a posture; None where the description does not have it."""
        if self.meta["schema_version"] < STEP_SCHEMA or not len(self.file["meta/inertia"]):
            return None
        return packing.PostureInertia(self.file["meta/inertia"][:], self.meta["inertia_lower"],
                                      self.meta["inertia_upper"])

    def _law(self, column, values):
        """As _rule, by a law that is known from STEP_SCHEMA on; None without one."""
        at, meta, inertia = self._block, self.meta, self._inertia() if column in MOTION else None
        if self._has_steps(column):
            return lambda row: extrapolated(values, row, packing.STEP_POLYNOMIALS[column])
        if column == "qd_s" and inertia is not None:
            return packing.SteppedVelocity(at, inertia, meta, lambda row: extrapolated(values, row, 5))
        if column == "f_s" and inertia is not None:
            return lambda row: packing.inertial_effort(at, inertia, meta["k_pm"], meta["period_s"], row)
        if column == "bodies":
            return packing.BodyMotion(values, meta["period_s"])
        if column == "alpha":
            return lambda row: extrapolated(values, row, 4)
        if column == "wall":
            return lambda row: packing.wall_position(at, values, row)
        if column == "exercise_effort":
            return lambda row: packing.wall_effort(at, values, row)
        if column == "phi" and len(meta["effort_dead"]):
            return packing.ActivatedDamping(at, meta, values)
        if column == "tank" and len(meta["device_damping"]):
            dissipated = packing.DissipatedEnergy(at, meta)
            return lambda row: self._whole_tank(values, row, dissipated(row))
        return None

    def _rule(self, column, values):
        """What row `row` of every chunk is expected to hold, the operations in the order of the file format."""
        period_s, meta = self.meta["period_s"], self.meta
        at = self._block
        law = self._law(column, values) if meta["schema_version"] >= STEP_SCHEMA else None
        if law is not None:
            return law
        later = meta["schema_version"] >= ROW_ELEMENT_SCHEMA
        if meta["schema_version"] >= GRID_SCHEMA and column in GRID_STEPS:
            steps = GRID_STEPS[column]
            return lambda row: numpy.rint(extrapolated(values, row, 3) * steps) / steps + 0.0
        if later and column == "intention":
            return learning.Oscillation(values)
        if column in POLYNOMIALS:
            order = LATER_POLYNOMIALS.get(column, POLYNOMIALS[column]) if later else POLYNOMIALS[column]
            return lambda row: extrapolated(values, row, order)
        if column == "time_s":
            return lambda row: at("tick")[:, row] * period_s
        if column == "q_s":
            return lambda row: values[:, row - 1] + period_s * at("qd_s")[:, row] if row else 0.0
        if column == "qd_mf":
            return lambda row: self._filtered(values, row) if row else 0.0
        if column == "theta":
            return self._joints
        if column == "f_s" and later:
            return learning.CriticallyDampedEffort(self, values)
        if column == "f_s":
            return lambda row: self._avatar_effort(values, row)
        if column == "coupling":
            def coupling(row):
                spring = meta["k_pm"] * self._stretch(row)
                return meta["gamma"] * (spring - at("f_s")[:, row]) - spring
            return coupling
        if column == "phi":
            return lambda row: decayed(values, row)
        if column == "damping":
            k_dm = meta["k_dm"]
            return lambda row: -at("phi")[:, row] * k_dm * at("qd_mf")[:, row] if len(k_dm) else 0.0
        if column == "rendered":
            return lambda row: (((at("coupling")[:, row] + at("exercise_effort")[:, row]) + at("damping")[:, row])
                                + at("tank_effort")[:, row])
        if column == "tank":
            return lambda row: self._tank(values, row)
        source = {"sent": "rendered", "palm_target_distance_m": "palm_distance_m"}[column]
        return lambda row: at(source)[:, row]

    def _stretch(self, row):
        return self._block("q_m")[:, row] - self._block("q_s")[:, row]

    def _rate(self, row):
        return self._block("qd_mf")[:, row] - self._block("qd_s")[:, row]

    def _filtered(self, values, row):
        tau_s, q_m = self.meta["filter_tau_s"], self._block("q_m")
        elapsed_s = self._block("elapsed_periods")[:, row] * self.meta["period_s"]
        return (tau_s * values[:, row - 1] + (q_m[:, row] - q_m[:, row - 1])) / (tau_s + elapsed_s)

    def _joints(self, row):
        q_s = self._block("q_s")[:, row]
        synergy = self.meta["synergy"].reshape(-1, q_s.shape[1])
        theta = numpy.tile(self.meta["theta0"], (len(q_s), 1))
        for joint, axis in zip(*numpy.nonzero(synergy)):
            theta[:, joint] += synergy[joint, axis] * q_s[:, axis]
        return theta

    def _avatar_effort(self, values, row):
        k_pm = self.meta["k_pm"]
        damping = 0.0
        if row > 0:
            rate = self._rate(row - 1)
            damping = (values[:, row - 1] - k_pm * self._stretch(row - 1)) / rate
            damping = numpy.where(rate != 0.0, damping, 0.0)
        return k_pm * self._stretch(row) + damping * self._rate(row)

    def _stored(self, row):
        k_pm, most = self.meta["k_pm"], self._block("effort_limit")[:, row]
        stretch = abs(self._stretch(row))
        return numpy.where(k_pm * stretch < most, 0.5 * k_pm * stretch * stretch,
                           most * stretch - 0.5 * most * most / k_pm)

    def _whole_tank(self, values, row, dissipated):
        most = self.meta["tank_capacity"]
        energy = self._tank(values, row, dissipated, packing.wall_stored)
        if row < int(self.meta["output_delay_ticks"]) + 2:
            return energy
        return numpy.where(energy > most, most, numpy.where(energy < -most, -most, energy))

    def _tank(self, values, row, dissipated=0.0, wall_stored=None):
        if not len(self.meta["k_pm"]):
            return extrapolated(values, row, 2)
        delay, at = int(self.meta["output_delay_ticks"]), self._block
        if row < delay + 2:
            return values[:, row - 1] if row > 0 else 0.0
        most, effort = at("effort_limit")[:, row - 1], at("f_s")[:, row - 1]
        avatar = numpy.where(effort > most, most, numpy.where(effort < -most, -most, effort))
        acted = at("sent")[:, row - delay - 1]
        hidden = 0.5 * self.meta["encoder_step"] * abs(acted - at("sent")[:, row - delay - 2])
        moved = at("q_m")[:, row] - at("q_m")[:, row - 1]
        stored, before = self._stored(row), self._stored(row - 1)
        if wall_stored is not None:
            stored, before = stored + wall_stored(at, row), before + wall_stored(at, row - 1)
        to_person = ((acted * moved + (stored - before)) + hidden) - dissipated
        given = to_person + avatar * (at("q_s")[:, row] - at("q_s")[:, row - 1])
        return values[:, row - 1] - given


def row_shape(dataset):
    """Shape of one row, whether it is one element of the dataset (an array) or many."""
    return (*dataset.shape[1:], *dataset.dtype.shape)
