"""Recounts from the raw columns of a recording who moved the hand in each part of a session, and for how long the person
was active.

It is independent of the program's implementation (src/replay/therapy_facts.hpp and src/loop/core/active_time.hpp state
the rules): it works on whole columns and takes only the compared figures from a report and from the measures."""
import json
import math
import random

import h5py
import numpy

from app import DONE, NOT_WHOLE, SEED, AppTest, lose_ticks, read_recording, report_data

NOBODY, PERSON, VIRTUAL_PATIENT, MOTION = range(4)  # ticks/moved_by
UNSPECIFIED, FULL_HELP, SOME_HELP, NO_HELP = range(4)    # ticks/help
ENDS = ("drink_done", "band_held", "level_done")
BEGINS = ("engaged", "pour_began", "band_entered")
FREES = ("disengaged", "step_done", "band_held", "restarted", "drink_done")
REACHED = ("engaged", "band_entered")
BRIDGE_S, GRIP_N, GRIP_S = 0.2, 1.0, 1.0
REACH_S, WITHIN_S, ROUNDING_S = 0.1, 2.0, 1e-6
LEAST_MOVE = {"m": 1e-3, "rad": math.radians(1)}
HOLDER_SILENT = 1 << 20  # docs/safety.md, bits of `faults`
AIM = 4                  # commands/type
MISSING = numpy.array([0x7FC57481], numpy.uint32).view(numpy.float32)[0]  # docs/recording.md: a number that is missing


def texts(attribute):
    return [text.decode() if isinstance(text, bytes) else str(text) for text in attribute]


class Recount:
    """A person's figures in a recording, from its columns alone."""

    def __init__(self, path):
        with read_recording(path) as f:
            tick = f["ticks/tick"][:]
            rows = numpy.flatnonzero(tick >= 0)  # docs/recording.md: the other ticks were lost
            self.lost = len(rows) < len(tick)
            new = numpy.full(len(tick), -1)
            new[rows] = numpy.arange(len(rows))
            self.time_s = f["ticks/time_s"][:][rows]
            self.by, self.help = (f[f"ticks/{name}"][:][rows] for name in ("moved_by", "help"))
            self.periods = numpy.maximum(f["ticks/elapsed_periods"][:][rows], 1).astype(numpy.int64)
            self.period_s = float(f["meta"].attrs["period_s"])
            self.tick = tick[rows]
            meta = f["meta"].attrs
            self.event_names, self.value_names = (texts(meta[name]) for name in ("event_names", "value_names"))
            self.values = f["ticks/exercise_values"][:][rows].astype(float) if self.value_names else numpy.zeros((len(rows), 0))
            self.events = [(int(new[row]), self.event_names[kind], int(index), float(value)) for row, kind, index, value in
                           zip(*(f[f"events/{name}"][:] for name in ("row", "type", "index", "value")))
                           if 0 <= row < len(tick) and new[int(row)] >= 0]
            self.axes, self.units = texts(meta["axis_names"]), texts(meta["axis_units"])
            self.q_m, self.intention = (f[f"ticks/{name}"][:][rows].astype(float) for name in ("q_m", "intention"))
            self.silent = f["ticks/faults"][:][rows] & HOLDER_SILENT != 0
            aims = f["commands/row"][:][f["commands/type"][:] == AIM]
            self.aimed = numpy.zeros(len(rows), bool)
            self.aimed[[new[int(row)] for row in aims if 0 <= row < len(tick) and new[int(row)] >= 0]] = True
            self.bodies = texts(f["ticks/bodies"].attrs["labels"]) if "bodies" in f["ticks"] else []
            # Keeps as many contacts of each row as the row counts; contacts that were never written have row -1.
            of_row = f["contacts/row"][:]
            written = numpy.flatnonzero((of_row >= 0) & (of_row < len(tick)))
            of_row = of_row[written]
            by_row = numpy.argsort(of_row, kind="stable")
            first = numpy.searchsorted(of_row[by_row], of_row[by_row])
            kept = numpy.zeros(len(of_row), bool)
            kept[by_row] = numpy.arange(len(of_row)) - first < f["ticks/contact_count"][:][of_row[by_row]]
            kept &= new[of_row] >= 0
            self.contact_row = new[of_row[kept]]
            self.contact_body = f["contacts/body"][:][written][kept]
            self.contact_n = numpy.linalg.norm(f["contacts/force_n"][:][written][kept].astype(float), axis=1)
        self.persons = numpy.where(self.by == PERSON, self.periods, 0)

        self.interrupted = self.silent | (self.value("paused") > 0.5)

    def value(self, name):
        """A column of the exercise's values; zeros without it."""
        return self.values[:, self.value_names.index(name)] if name in self.value_names else numpy.zeros(len(self.by))

    def active(self):
        """The periods in which the person was active, the helped part of them, and those in which the hand was led."""
        kind = numpy.where((self.by != PERSON) | self.interrupted, 0, numpy.where(self.help == FULL_HELP, 2, 1))
        cuts = [0, *(numpy.flatnonzero(numpy.diff(kind)) + 1), len(kind)]
        counted = numpy.zeros(len(kind), bool)
        for begin, end in zip(cuts, cuts[1:]):
            if kind[begin] != 0:
                times_s = self.time_s[begin:end]
                last_s = numpy.maximum.accumulate(numpy.where(self.moves(begin, end), times_s, -numpy.inf))
                counted[begin:end] = times_s - last_s <= WITHIN_S + ROUNDING_S
        own, led = counted & (kind == 1), counted & (kind == 2)
        return [int(self.periods[which].sum()) for which in (own, own & (self.help == SOME_HELP), led)]

    def moves(self, begin, end):
        """The rows among these in which the person moves the hand, or grips in a device."""
        known = numpy.isfinite(self.intention[begin:end, 0])
        aimed = numpy.logical_or.accumulate(self.aimed[begin:end] & known)
        at = numpy.where(known[:, None], self.intention[begin:end], self.q_m[begin:end]).tolist()
        least = [LEAST_MOVE[unit] for unit in self.units]
        here, away = at[0], []
        for now in at:
            away.append(any(abs(a - b) >= d for a, b, d in zip(now, here, least)))
            here = now if away[-1] else here
        grips = self.value("squeeze_n")[begin:end] >= GRIP_N
        return (away & (aimed | ~known)) | (grips & ~known)

    def way(self):
        """The hand's way in space up to each row, in steps of at least 1 mm."""
        columns = [self.axes.index(axis) for axis in ("x", "y", "z") if axis in self.axes]
        way, here, sum_m = [], None, 0.0
        for place in self.q_m[:, columns].tolist():
            here = place if here is None else here
            step_m = math.dist(place, here)
            if step_m >= 1e-3:
                sum_m, here = sum_m + step_m, place
            way.append(sum_m)
        return way

    def share(self, first, last):
        """The person's share of the rows first to last."""
        return self.persons[first:last + 1].sum() / self.periods[first:last + 1].sum()

    def most_help(self, first, last):
        given = set(self.help[first:last + 1][self.by[first:last + 1] == PERSON])
        return next((help for help in (FULL_HELP, SOME_HELP, NO_HELP) if help in given), UNSPECIFIED)

    def part_of(self, place):
        """(first row, last row) of the part that the event at this index of self.events ends."""
        last, name = self.events[place][:2]
        start, after = 0, 0  # the earliest row in which the part can begin, and the first event
        for i in range(place - 1, -1, -1):
            row, what = self.events[i][:2]
            if what in (name, "restarted"):
                start, after = (row if what == "restarted" else row + 1), i + 1
                break
        begun = [row for row, what, *_ in self.events[after:place + 1] if what in BEGINS]
        return (begun[0] if begun else start), last

    def parts(self):
        """Yields for each event that ends a part: (name, index, value, share, help, last row, litres of its steps)."""
        for place, (row, name, index, value) in enumerate(self.events):
            if name not in ENDS:
                continue
            first, last = self.part_of(place)
            litres = 0.0
            for i in range(place - 1, -1, -1):
                if self.events[i][1] in ("drink_done", "restarted"):
                    break
                litres += self.events[i][3] if self.events[i][1] == "step_done" else 0.0
            yield name, index, value, self.share(first, last), self.most_help(first, last), last, litres

    def reaches(self):
        """Yields (time, share) of each reach."""
        free, way = 0, self.way()
        for row, name, *_ in self.events:
            if free is not None and self.interrupted[free:row + 1].any():
                free = None
            if name in REACHED and free is not None:
                took_s = self.time_s[row] - self.time_s[free]
                if took_s >= REACH_S - ROUNDING_S and (name != "engaged" or way[row] > way[free]):
                    yield took_s, self.share(free, row)
                free = None
            if name in FREES and not self.interrupted[row]:
                free = row

    def touches(self, body):
        """Yields (share, largest force) of each touch."""
        here = self.contact_body == body
        rows, force_n = numpy.unique(self.contact_row[here], return_inverse=True)
        sums_n = numpy.bincount(force_n, weights=self.contact_n[here], minlength=len(rows))
        ends_s = self.time_s[rows] + self.periods[rows] * self.period_s
        cut = numpy.flatnonzero(self.time_s[rows][1:] - ends_s[:-1] > BRIDGE_S) + 1
        for part in numpy.split(numpy.arange(len(rows)), cut):
            if len(part):
                yield self.share(rows[part[0]], rows[part[-1]]), sums_n[part].max()

    def grips(self):
        """Yields (share, time, mean force) of each grip."""
        if "squeeze_n" not in self.value_names:
            return
        force_n = self.values[:, self.value_names.index("squeeze_n")]
        # A grip ends where the next ticks are missing.
        breaks = numpy.concatenate([[True], numpy.diff(self.tick).astype(numpy.int64) != self.periods[1:]])
        grips = force_n >= GRIP_N
        begins = numpy.flatnonzero(grips & (breaks | ~numpy.concatenate([[False], grips[:-1]])))
        for begin in begins:
            end = begin
            while end + 1 < len(grips) and grips[end + 1] and not breaks[end + 1]:
                end += 1
            t = self.time_s[begin:end + 1]
            if t[-1] - t[0] < GRIP_S:
                continue
            inner = (t - t[0] >= 0.25) & (t[-1] - t >= 0.25)
            yield self.share(begin, end), t[-1] - t[0], force_n[begin:end + 1][inner].mean()


def hand_over(path, draw, given=None):
    """Changes who moved the hand in a recording at random ticks, some of them at or next to the border of a part.
    Sometimes also removes ticks.

    given -- the help that the person surely has for half of the session"""
    own = Recount(path)
    moments = [row for row, name, *_ in own.events if name in ENDS + BEGINS + ("restarted",)]
    rows = len(own.by)
    cuts = {0, rows}
    for _ in range(draw.choice((0, 1, 2, 3, 8, 40))):
        at_event = moments and draw.random() < 0.7
        cuts.add(min(rows, max(0, draw.choice(moments) + draw.choice((-1, 0, 1))) if at_event else draw.randrange(rows)))
        if draw.random() < 0.2:
            cuts.add(min(rows, max(cuts - {rows}) + 1))  # changes back after one tick
    cuts = sorted(cuts)
    mostly = draw.choice((PERSON, PERSON, VIRTUAL_PATIENT))
    with h5py.File(path, "r+", libver="latest") as f:
        by, help = f["ticks/moved_by"], f["ticks/help"]
        for begin, end in zip(cuts, cuts[1:]):
            who = mostly if draw.random() < 0.6 else draw.choice((NOBODY, PERSON, VIRTUAL_PATIENT, MOTION))
            by[begin:end] = who
            help[begin:end] = draw.choice((UNSPECIFIED, FULL_HELP, SOME_HELP, NO_HELP)) if who == PERSON else UNSPECIFIED
        if given is not None:
            begin = draw.randrange(rows // 2)
            by[begin:begin + rows // 2], help[begin:begin + rows // 2] = PERSON, given
    if draw.random() < 0.3:
        begin = draw.randrange(1, rows - 2)
        lose_ticks(path, begin, min(rows - 1, begin + draw.choice((1, 7, 400))))


def live_through(path, draw, lives=False):
    """Lets the person of a recording rest, pause, leave and aim at random; some are in a device, whose intention nobody
    knows.

    lives -- the person surely aims, and no interruption lasts long"""
    with h5py.File(path, "r+", libver="latest") as f:
        ticks, rows = f["ticks"], len(f["ticks/tick"])

        def spans(most):
            for _ in range(draw.randrange(most + 1)):
                begin = draw.randrange(rows)
                yield begin, min(rows, begin + draw.choice((1, 30, 700, 1999, 2001, 6000) + (() if lives else (rows,))))

        for begin, end in spans(4):
            for name in ("q_m", "intention"):
                ticks[name][begin:end] = ticks[name][begin]
        for begin, end in spans(2):
            ticks["faults"][begin:end] = ticks["faults"][begin:end] | HOLDER_SILENT
        names = texts(f["meta"].attrs["value_names"])
        for begin, end in spans(2):
            ticks["exercise_values"][begin:end, names.index("paused")] = 1
        if draw.random() < 0.3:
            ticks["intention"][:] = MISSING
        if len(f["commands/row"]) > 0:
            return  # it has aims
        aims = sorted(draw.sample(range(rows), 40 if lives else draw.choice((0, 1, 40))))
        for name, value in (("row", aims), ("type", AIM), ("index", NO_HELP), ("value", 0.0), ("aim", 0.0)):
            column = f[f"commands/{name}"]
            column.resize(len(aims), axis=0)
            column[:] = value
        for row in aims:
            ticks["command_count"][row] = 1


class Compared(AppTest):
    def compare(self, path):
        """Compares a report's figures with the recount and returns the recount."""
        own = Recount(path)
        self.expect(self.run_app("replay", path, "--report", "page.html"), NOT_WHOLE if own.lost else DONE)
        said = report_data(self.folder / "page.html")["therapy"]
        self.assertEqual(said["moved"]["by"], [int(own.periods[own.by == by].sum()) for by in range(4)])
        self.assertEqual(said["moved"]["helped"],
                         [int(own.periods[(own.by == PERSON) & (own.help == help)].sum()) for help in range(4)])
        self.assertEqual([said["moved"][f"{name}_periods"] for name in ("active", "helped", "led")], own.active())
        self.compare_measures(path, own)
        self.assertEqual(said["moved"]["share"], own.share(0, len(own.by) - 1))  # exact to the tick
        parts = list(own.parts())
        self.compare_parts(said, own, parts)
        self.compare_results(said, own, parts)
        self.compare_hand(said, own)
        return own

    def compare_measures(self, path, own):
        """The measures of `wholehand measures`, which the clinic keeps."""
        measured = json.loads(self.expect(self.run_app("measures", path), DONE).out)
        for name, periods in zip(("active_s", "helped_s", "led_s"), own.active()):
            self.assertAlmostEqual(measured[name], periods * own.period_s, delta=1e-9)
        mine = [took for took, share in own.reaches() if share == 1]
        self.assertEqual(measured["reaches"], len(mine))
        if mine:
            self.assertAlmostEqual(measured["reach_s"], numpy.mean(mine), delta=1e-9)
            self.assertGreater(min(mine), 0.09)
        else:
            self.assertIsNone(measured["reach_s"])

    def compare_drawn(self, bases, cases):
        """Compares copies of these recordings with random lives and hand-overs; returns the kinds of parts that occurred,
        and in how many sessions somebody was active, helped, led and reached."""
        kinds, lived = set(), [0, 0, 0, 0]
        for case in range(cases):
            seed = 1000 * SEED + case
            with self.subTest(seed=seed):
                path = self.folder / "drawn.h5"
                path.write_bytes(bases[case % len(bases)].read_bytes())
                draw = random.Random(seed)
                # Each kind of help is surely given to an active person once in every base.
                given = dict(enumerate((NO_HELP, SOME_HELP, FULL_HELP))).get(case // len(bases))
                live_through(path, draw, given is not None)
                hand_over(path, draw, given)
                own = self.compare(path)
                kinds |= {(name, "all" if share == 1 else "none" if share == 0 else "part")
                          for name, _, _, share, *_ in own.parts()}
                times = [*own.active(), sum(share == 1 for _, share in own.reaches())]
                lived = [count + (time > 0) for count, time in zip(lived, times)]
        return kinds, lived

    def compare_parts(self, said, own, parts):
        self.assertEqual([(p["event"], p["index"], p["value"], p["share"], p["help"]) for p in said["parts"]],
                         [(name, index, value, share, help) for name, index, value, share, help, *_ in parts])
        for p, (_, _, _, share, *_) in zip(said["parts"], parts):
            self.assertEqual(p["persons"], share == 1)
        for name in set(ENDS) & set(own.event_names):
            shares = [share for what, _, _, share, *_ in parts if what == name]
            self.assertEqual([said["sums"][name][key] for key in ("count", "shared", "others")],
                             [sum(s == 1 for s in shares), sum(0 < s < 1 for s in shares), sum(s == 0 for s in shares)])
        reaches = list(own.reaches())
        mine = [took for took, share in reaches if share == 1]
        self.assertEqual(said["reaches"]["count"], len(mine))
        self.assertEqual(said["reaches"]["others"], sum(share == 0 for _, share in reaches))
        self.assertAlmostEqual(said["reaches"]["sum_s"], sum(mine), delta=1e-9)

    def compare_results(self, said, own, parts):
        results = {line["name"]: line["value"] for line in said["results"]}
        if "drink_done" in own.event_names:
            drinks = [part for part in parts if part[0] == "drink_done" and part[3] == 1]
            self.assertAlmostEqual(results["poured_total_l"], 1000 * sum(part[6] for part in drinks), delta=1e-4)  # ml
            stars = own.values[:, own.value_names.index("stars")]
            self.assertEqual(said["sums"]["drink_done"]["stars"], sum(stars[part[5]] for part in drinks))
            scores = [part[2] for part in drinks]
        else:
            self.assertEqual(results["bands_done"], sum(part[0] == "band_held" and part[3] == 1 for part in parts))
            scores = [part[2] for part in parts if part[0] == "level_done" and part[3] == 1]
        if scores:
            self.assertAlmostEqual(results["score"], numpy.mean(scores), delta=1e-9)
        else:
            self.assertIsNone(results["score"])

    def compare_hand(self, said, own):
        bodies = {body["name"]: body for body in said["bodies"]}
        for index, name in enumerate(own.bodies):
            mine = [most_n for share, most_n in own.touches(index) if share == 1]
            self.assertEqual(name in bodies, bool(mine), name)
            if mine:
                self.assertEqual(bodies[name]["touches"], len(mine), name)
                self.assertAlmostEqual(bodies[name]["largest_force_n"], max(mine), delta=1e-9)
        grips = list(own.grips())
        mine = [(took, mean) for share, took, mean in grips if share == 1]
        self.assertEqual([said["grips"][key] for key in ("count", "shared", "others")],
                         [len(mine), sum(0 < share < 1 for share, *_ in grips), sum(share == 0 for share, *_ in grips)])
        if mine:
            self.assertAlmostEqual(said["grips"]["mean_n"], numpy.average([m for _, m in mine], weights=[t for t, _ in mine]),
                                   delta=2e-3)
        total_n = numpy.bincount(own.contact_row, weights=own.contact_n, minlength=len(own.by))
        strongest_n = total_n[own.by == PERSON].max(initial=0.0)
        self.assertAlmostEqual(said["largest_force_n"], strongest_n, delta=1e-9)
        if strongest_n > 0:
            row = int(numpy.flatnonzero((own.by == PERSON) & (total_n >= strongest_n - 1e-9))[0])
            self.assertEqual(said["strongest"]["time_s"], own.time_s[row])
