// Checks the estimate of a person's own movement with drawn patients.
#include "loop/psychometrics/own_range.hpp"

#include "loop/core/geometry.hpp"
#include "support/seed.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <vector>

namespace wholehand::test {
namespace {

constexpr double kSample_s = RangeMeter::kSample_s;

/// Measures a try of these samples, from rest on.
RangeTry judgeTry(const std::vector<double>& q, int direction, const RangeRules& rules) {
  RangeMeter meter;
  meter.begin(rules, direction, q.empty() ? 0.0 : q.front());
  for (const double at : q) meter.add(at);
  return meter.judge();
}

/// A patient who moves to the end of the own range and holds it: with tone (a slow approach),
/// tremor, a hand that sinks, and jerks beyond the end.
struct RangePatient {
  double end, scale;  ///< scale: a degree, or 1.5 mm
  double tone_s, tremor, tremor_hz, sinks_per_s, jerk;
};

RangePatient drawnPatient(std::mt19937_64& random, bool translation) {
  const double scale = translation ? 1.5e-3 : kDeg;
  return {scale * uniform(random, 25.0, 110.0),
          scale,
          uniform(random, 0.1, 0.5),
          scale * uniform(random, 0.0, 2.0),
          uniform(random, 4.0, 8.0),
          scale * uniform(random, 0.0, 0.7),
          scale * (random() % 3 == 0 ? uniform(random, 5.0, 15.0) : 0.0)};
}

std::vector<double> tryOf(const RangePatient& p, int direction, std::mt19937_64& random) {
  const double phase = uniform(random, 0.0, 6.28), jerk_at_s = uniform(random, 1.0, 3.0);
  const double end = p.end + p.scale * uniform(random, -0.5, 0.5);
  std::vector<double> q;
  for (int i = 0; i < 200; ++i) {
    const double t = i * kSample_s - 0.5;
    double at = t > 0.0 ? end * (1.0 - std::exp(-t / p.tone_s)) : 0.0;
    if (t > 1.0) at -= p.sinks_per_s * (t - 1.0);
    at += p.tremor * std::sin(2.0 * std::numbers::pi * p.tremor_hz * t + phase);
    if (std::abs(t - jerk_at_s) < 0.06) at += p.jerk;
    q.push_back(direction * at);
  }
  return q;
}

TEST(OwnRange, OneTry_IsItsHeldEndAndNeverItsPeak) {
  const RangeRules rules = rangeRulesOf(false);
  std::vector<double> q(150, 0.0);
  for (std::size_t i = 25; i < q.size(); ++i) q[i] = 40.0 * kDeg;
  for (std::size_t i = 75; i < 80; ++i) q[i] = 90.0 * kDeg;  // a jerk of 0.1 s
  const RangeTry held = judgeTry(q, 1, rules);
  // The jerk moves the outer part beyond what is held: 0.6 · 90 > 40.
  EXPECT_EQ(held.kind, TryKind::kJerk);
  for (std::size_t i = 75; i < 80; ++i) q[i] = 55.0 * kDeg;
  EXPECT_EQ(judgeTry(q, 1, rules).kind, TryKind::kHeld);
  EXPECT_NEAR(judgeTry(q, 1, rules).value, 40.0 * kDeg, 1e-12);
  for (double& at : q) at = -at;
  EXPECT_NEAR(judgeTry(q, -1, rules).value, -40.0 * kDeg, 1e-12);
}

TEST(OwnRange, WhatIsNoTry_IsToldApart) {
  const RangeRules rules = rangeRulesOf(false);
  const auto kindOf = [&](auto at) {
    std::vector<double> q;
    for (int i = 0; i < 300; ++i) q.push_back(at(i * kSample_s) * kDeg);
    return judgeTry(q, 1, rules).kind;
  };
  EXPECT_EQ(kindOf([](double) { return 0.0; }), TryKind::kNoMovement);
  EXPECT_EQ(kindOf([](double t) { return 4.0 * std::min(t, 1.0); }), TryKind::kNoMovement);
  EXPECT_EQ(kindOf([](double t) { return 5.0 * t; }), TryKind::kDrift);  // slowly, all the time
  EXPECT_EQ(kindOf([](double t) { return t > 2.0 && t < 2.2 ? 50.0 : 0.0; }), TryKind::kJerk);
  EXPECT_EQ(kindOf([](double t) { return 30.0 * std::sin(6.0 * t); }), TryKind::kJerk);
  EXPECT_EQ(kindOf([](double t) { return 60.0 * std::min(1.0, 2.0 * t); }), TryKind::kHeld);
  // A person who falls asleep: the hand stays down.
  EXPECT_EQ(kindOf([](double t) { return 0.3 * std::sin(t); }), TryKind::kNoMovement);
  EXPECT_EQ(judgeTry(std::vector<double>{}, 1, rules).kind, TryKind::kNoMovement);
}

/// A person who approaches the end slowly, e^(−t/τ), is not interrupted before it: when the meter
/// has seen no advance for a second, what is left of the way is below 1°.
TEST(OwnRange, SlowPerson_IsWaitedFor) {
  for (const double tone_s : {0.1, 0.5, 1.0, 2.0}) {
    RangeMeter meter;
    meter.begin(rangeRulesOf(false), 1, 0.0);
    double left = 0.0;
    for (int i = 0; meter.sinceAdvance_s() < 1.0; ++i) {
      ASSERT_LT(i, RangeMeter::kMostSamples);
      left = 100.0 * kDeg * std::exp(-i * kSample_s / tone_s);
      meter.add(100.0 * kDeg - left);
    }
    EXPECT_LT(left, 1.0 * kDeg) << tone_s;
    EXPECT_NEAR(meter.judge().value, 100.0 * kDeg, 1.0 * kDeg) << tone_s;
  }
}

TEST(OwnRange, SeveralTries_GiveTheMiddleOne) {
  const auto held = [](double value) { return RangeTry{TryKind::kHeld, value}; };
  const RangeTry jerk{TryKind::kJerk, 9.0};
  EXPECT_EQ(ownEnd(std::vector{held(1.0), held(3.0), held(2.0)}).value, 2.0);
  EXPECT_EQ(ownEnd(std::vector{held(1.0), jerk, held(2.0)}).value, 1.5);
  EXPECT_FALSE(ownEnd(std::vector{held(1.0), jerk, jerk}).steady);
}

/// 100 patients, an end of a rotation or a translation each: within 2° and 3 mm of their own, and
/// at most 5 are not steady.
TEST(OwnRange, DrawnPatients_AreMeasured) {
  auto random = seededRandom(6609);
  int unsteady = 0, beyond = 0;
  double worst_deg = 0.0, worst_mm = 0.0;
  for (int i = 0; i < 100; ++i) {
    const bool translation = i % 2 == 0;
    const int direction = i % 4 < 2 ? 1 : -1;
    const RangePatient patient = drawnPatient(random, translation);
    std::vector<RangeTry> tries;
    for (int n = 0; n < 3; ++n) {
      tries.push_back(
          judgeTry(tryOf(patient, direction, random), direction, rangeRulesOf(translation)));
    }
    const OwnEnd end = ownEnd(tries);
    if (!end.steady) {
      ++unsteady;
      continue;
    }
    const double off = std::abs(end.value - direction * patient.end);
    double& worst = translation ? worst_mm : worst_deg;
    worst = std::max(worst, translation ? 1e3 * off : off / kDeg);
    beyond += off > (translation ? 3e-3 : 2.0 * kDeg) ? 1 : 0;
  }
  std::printf("figure: own range, worst %.2f degrees, %.2f mm; %d of 100 not steady\n", worst_deg,
              worst_mm, unsteady);
  EXPECT_EQ(beyond, 0);
  EXPECT_LE(unsteady, 5);
}

}  // namespace
}  // namespace wholehand::test
