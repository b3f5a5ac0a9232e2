"""`experiment thresholds`: the fit against an independent one, bad files, and what virtual observers show."""
import json
import math
import random
import re

from app import BAD_INPUT, DONE, FULL, AppTest, main

DROP = 2.15  # docs/experiments.md
GOLDEN = (math.sqrt(5) - 1) / 2


def normal(z):
    return 0.5 * math.erfc(-z / math.sqrt(2))


def largest(function, low, high, steps=44):
    """Golden section of a function with one top: its place and value."""
    c, d = high - GOLDEN * (high - low), low + GOLDEN * (high - low)
    at_c, at_d = function(c), function(d)
    for _ in range(steps):
        if at_c > at_d:
            high, d, at_d = d, c, at_c
            c = high - GOLDEN * (high - low)
            at_c = function(c)
        else:
            low, c, at_c = c, d, at_d
            d = low + GOLDEN * (high - low)
            at_d = function(d)
    ends = [(function(x), x) for x in (low, 0.5 * (low + high), high)]
    return max(ends)[::-1]


class Fit:
    """The definition of docs/experiments.md, maximized one variable inside another."""

    def __init__(self, answers):
        self.counts = {}
        for x, second in answers:
            self.counts[x, second] = self.counts.get((x, second), 0) + 1

    def posterior(self, u, bias, lapse):
        total = -0.5 * ((u - math.log(0.2)) / 2) ** 2 - 0.5 * (bias / 0.5) ** 2
        for (x, second), count in self.counts.items():
            z = (x + bias) / (math.sqrt(2) * math.exp(u))
            total += count * math.log(lapse / 2 + (1 - lapse) * normal(z if second else -z))
        return total

    def profile(self, u):
        return largest(lambda bias: largest(lambda lapse: self.posterior(u, bias, lapse), 0.0, 0.06)[1], -1.0, 1.0)[1]

    def crossing(self, inside, outside, value):
        for _ in range(36):
            middle = 0.5 * (inside + outside)
            inside, outside = (middle, outside) if self.profile(middle) >= value else (inside, middle)
        return math.exp(0.5 * (inside + outside))


class Thresholds(AppTest):
    def answers(self, sigma, lapse, draw):
        """Fifty answers at levels of the scale."""
        out = []
        for _ in range(50):
            x = 0.02 * (math.log(3) / 0.02) ** (draw.randrange(8, 24) / 23) * draw.choice((-1, 1))
            right = draw.random() < (1 - lapse) * normal(abs(x) / (math.sqrt(2) * sigma)) + lapse / 2
            out.append((x, right == (x > 0)))
        return out

    def fit(self, answers):
        path = self.folder / "answers.csv"
        path.write_text("x,other,said_second,is_catch\n" + "".join(f"{x!r},0,{int(second)},0\n" for x, second in answers))
        self.expect(self.run_app("experiment", "thresholds", "--fit", path, "--json", "fit.json"), DONE, "sigma")
        return json.loads((self.folder / "fit.json").read_text())

    def test_fit_and_interval_are_those_of_an_independent_implementation(self):
        draw = random.Random(65)
        for sigma, lapse in ((0.1, 0.0), (0.2, 0.03), (0.4, 0.05))[:None if FULL else 2]:
            with self.subTest(sigma=sigma):
                answers = self.answers(sigma, lapse, draw)
                found, own = self.fit(answers), Fit(answers)
                u, top = largest(own.profile, math.log(0.02), math.log(3.0))
                self.assertAlmostEqual(found["log_posterior"], top, delta=1e-6)
                # The top is flat: its place is known to the root of the precision of its value.
                self.assertAlmostEqual(found["sigma"], math.exp(u), delta=3e-6)
                self.assertAlmostEqual(found["low"], own.crossing(u, math.log(0.005), top - DROP), delta=1e-6)
                self.assertAlmostEqual(found["high"], own.crossing(u, math.log(5.0), top - DROP), delta=1e-6)

    def test_answers_that_do_not_compare_are_named(self):
        said = [(0.5 if i % 2 else -0.5, i % 4 < 2) for i in range(60)]
        self.assertTrue(self.fit(said)["guesses"])
        self.assertTrue(self.fit([(x, True) for x, _ in said])["one_answer"])
        self.assertFalse(self.fit([(0.5, True)] * 5)["enough"])

    def test_bad_files_are_refused_at_their_line(self):
        for text, said in (("", "no answers"), ("0.1,0,1,0\n0,0,1,0\n", ":2"), ("0.1,0,2,0\n", ":1"), ("nan,0,1,0\n", ":1"),
                           ("0.1,0,1\n", ":1"), ("0.1,0,1,0,5\n", ":1"), ("squeeze\n", ":1")):
            with self.subTest(text):
                (self.folder / "bad.csv").write_text(text)
                self.expect_refused(self.run_app("experiment", "thresholds", "--fit", "bad.csv"), "bad.csv", said, lines=1)
        self.expect(self.run_app("experiment", "thresholds", "--fit", "missing.csv"), BAD_INPUT, "missing.csv")

    def test_virtual_observers_are_fitted_and_doubted(self):
        blocks = 2000 if FULL else 12
        self.expect(self.run_app("experiment", "thresholds", "--blocks", str(blocks), "--json", "all.json"), DONE, "guesses")
        rows = {row["observer"]: row for row in json.loads((self.folder / "all.json").read_text())["observers"]}
        self.assertGreaterEqual(rows["guesses"]["doubted"], 0.99 if FULL else 0.8)
        self.assertGreaterEqual(rows["says the first"]["doubted"], 0.99 if FULL else 0.8)
        self.assertGreaterEqual(rows["compares position"]["doubted"], 0.95 if FULL else 0.7)
        for name, row in rows.items():
            if not re.match(r"sigma 0\.\d+, lapse", name):
                continue
            with self.subTest(name):
                self.assertLessEqual(abs(row["bias"]), 0.125 if FULL else 0.6)
                self.assertLessEqual(row["sd"], 0.40 if FULL else 1.0)
                self.assertGreaterEqual(row["covered"], 0.93 if FULL else 0.5)
                self.assertLessEqual(row["doubted"], 0.015 if FULL else 0.25)


if __name__ == "__main__":
    main()
