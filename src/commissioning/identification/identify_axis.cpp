#include "commissioning/identification/identify_axis.hpp"

#include "commissioning/identification/regression.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdio>
#include <numbers>
#include <vector>

namespace wholehand {
namespace {

constexpr double kShortest_s = 6.0;
constexpr double kStudent = 3.0;  // standard deviations: 99.5 % with some 15 blocks
// Extrapolation of the difference between a part of the data and the whole, because every part
// contains some of the disturbance of the whole.
constexpr double kExtrapolation = 2.0;
// Share of the unexplained effort that may hide in mass and delay (as with play).
constexpr double kHidden = 0.8;
// Smallest half widths: those that the method was tested to keep on ideal axes.
constexpr double kLeastMass = 0.02, kLeastFriction = 0.05, kLeastDelay_periods = 0.1;
// Largest half width over the middle. A certificate cannot use wider intervals.
constexpr double kMassWithin = 0.2, kDampingWithin = 0.35, kCoulombWithin = 0.5;
constexpr double kDelayWithin_periods = 2.5;
constexpr double kCoulombOfEffort = 0.05;  // smaller dry friction is negligible

using Figures = std::array<double, 5>;  // mass, damping, coulomb, gravity, delay
constexpr double kSlowShare = 0.15;     // least Stribeck speed that counts, share of the RMS speed
constexpr double kExplains = 0.8;       // share of the residual without it
enum : std::size_t { kMass, kDamping, kCoulomb, kGravity, kDelay };

Figures listed(const AxisFigures& f) {
  return {f.mass, f.damping, f.coulomb, f.gravity, f.delay_s};
}

// Standard deviations of the figures, from fits that leave out one block each (jackknife).
Figures scatterOf(const Regression& regression) {
  std::vector<Figures> without;
  for (const Regression::Sums& block : regression.blocks()) {
    if (block.isZero(0.0)) continue;
    without.push_back(listed(regression.fit(regression.all() - block, kPlain)));
  }
  const auto n = static_cast<double>(without.size());
  Figures out{};
  for (std::size_t i = 0; i < out.size(); ++i) {
    double mean = 0.0, sum = 0.0;
    for (const Figures& f : without) mean += f.at(i) / n;
    for (const Figures& f : without) sum += (f.at(i) - mean) * (f.at(i) - mean);
    out.at(i) = std::sqrt((n - 1.0) / n * sum);
  }
  return out;
}

// Estimates of the same figures from parts of the data and from other friction models.
std::vector<Figures> partialEstimates(const AxisTrace& trace, const Regression& whole) {
  std::vector<Figures> out;
  for (std::size_t i = 0; i < kStribeckSpeeds.size(); ++i) {
    out.push_back(listed(whole.fit(whole.all(), static_cast<FrictionModel>(i))));
  }
  for (const Regression::Sums& posture : whole.postures()) {
    out.push_back(listed(whole.fit(posture, kPlain)));
  }
  out.push_back(listed(whole.fit(whole.slow(), kPlain)));
  out.push_back(listed(whole.fit(whole.fast(), kPlain)));
  for (const double low_pass_hz : {1.5, 12.0}) {
    RegressionConfig config;
    config.low_pass_hz = low_pass_hz;
    const Regression band(trace, config);
    out.push_back(listed(band.fit(band.all(), kPlain)));
  }
  return out;
}

std::array<Interval, 5> intervals(const Figures& middle, const Figures& scatter,
                                  const std::vector<Figures>& others, const Figures& least) {
  std::array<Interval, 5> out;
  for (std::size_t i = 0; i < out.size(); ++i) {
    const double wide = std::max(kStudent * scatter.at(i), least.at(i));
    out.at(i) = {middle.at(i) - wide, middle.at(i) + wide};
    for (const Figures& other : others) {
      const double there = middle.at(i) + kExtrapolation * (other.at(i) - middle.at(i));
      out.at(i) = hull(out.at(i), {there, there});
    }
  }
  return out;
}

// Whether friction that falls with speed over a good part of the speeds fits much better.
bool fallsWithSpeed(const Regression& whole) {
  const double plain = whole.left(whole.all(), kPlain);
  double least = plain;
  std::size_t best = 0;
  for (std::size_t i = 0; i < kStribeckSpeeds.size(); ++i) {
    const double left = whole.left(whole.all(), static_cast<FrictionModel>(i));
    if (left < least) least = left, best = i;
  }
  return kStribeckSpeeds.at(best) >= kSlowShare && least < kExplains * plain;
}

std::string percent(double share) {
  std::array<char, 32> text{};
  std::snprintf(text.data(), text.size(), "%.0f %%", 100.0 * share);
  return text.data();
}

// Why a certificate cannot use these intervals; empty where it can.
Diagnostics refusals(const IdentifiedAxis& found, const std::string& axis, double period_s,
                     double effort) {
  Diagnostics out;
  const auto refuse = [&](const std::string& problem, const std::string& remedy) {
    out.push_back({"", 0, "axes", axis, problem, remedy});
  };
  const auto spread = [](const Interval& i) { return i.halfWidth() / std::abs(i.middle()); };
  if (!(found.mass.lower > 0.0) || spread(found.mass) > kMassWithin) {
    refuse(
        "its mass is not one number: parts of the motion differ by " + percent(spread(found.mass)),
        "look for play, a slack belt or a soft joint between motor and handle");
  }
  if (!(found.damping.upper > 0.0) || spread(found.damping) > kDampingWithin) {
    refuse("its friction is not viscous and dry: the damping of parts of the motion differs by " +
               percent(spread(found.damping)),
           "look for friction that falls with speed, cogging or a rubbing cable");
  }
  const bool felt = found.coulomb.upper > kCoulombOfEffort * effort;
  if (felt && spread(found.coulomb) > kCoulombWithin) {
    refuse("its dry friction is not one number: parts of the motion differ by " +
               percent(spread(found.coulomb)),
           "look for cogging, a rubbing cable or a bearing that sticks");
  }
  if (found.delay_s.halfWidth() > kDelayWithin_periods * period_s) {
    refuse("its delay is not one number", "look for play, and for a bus that is sometimes late");
  }
  return out;
}

// Figures from a band that reaches beyond the corner b/m: below it a larger mass resembles a longer
// delay. The encoder's steps forbid a wider band for every axis.
AxisFigures refined(const AxisTrace& trace, const IdentifiedAxis& found) {
  constexpr double kLeast_hz = 6.0, kCorners = 1.5;
  RegressionConfig config;
  const double corner_hz = found.figures.damping / found.figures.mass / (2.0 * std::numbers::pi);
  config.low_pass_hz = std::max(kLeast_hz, kCorners * corner_hz);
  const Regression band(trace, config);
  const AxisFigures f = band.fit(band.all(), kPlain);
  const auto within = [](const Interval& i, double x) { return std::clamp(x, i.lower, i.upper); };
  return {within(found.mass, f.mass), within(found.damping, f.damping),
          within(found.coulomb, f.coulomb), within(found.gravity, f.gravity),
          within(found.delay_s, f.delay_s)};
}

}  // namespace

Expected<IdentifiedAxis> identifyAxis(const AxisTrace& trace, const std::string& axis) {
  const double t = trace.period_s;
  const auto refused = [&axis](const char* problem, const char* remedy) {
    return Diagnostic{"", 0, "axes", axis, problem, remedy};
  };
  const std::size_t n = trace.position.size();
  if (static_cast<double>(n) * t < kShortest_s || trace.effort.size() != n ||
      trace.posture.size() != n) {
    return refused("was not measured for long enough", "measure it for 20 s");
  }
  IdentifiedAxis out;
  out.resolution = resolutionOf(trace);
  const auto [low, high] = std::minmax_element(trace.position.begin(), trace.position.end());
  if (!(*high - *low > 50.0 * out.resolution)) {
    return refused("did not move under the efforts that may be used",
                   "look for a brake, dry friction or an encoder that is too coarse");
  }
  const Regression whole(trace, {});
  out.figures = whole.fit(whole.all(), kPlain);
  if (fallsWithSpeed(whole)) {
    return refused("its friction falls with speed: it is not viscous and dry",
                   "look for a bearing or a seal that sticks, and lubricate it");
  }
  const Figures middle = listed(out.figures);
  const double effort = rootMeanSquare(trace.effort);
  const AxisFigures hidden = whole.hidden(whole.all(), out.figures, kPlain);
  const Figures least = {std::max(kLeastMass * std::abs(middle[kMass]), kHidden * hidden.mass),
                         kLeastFriction * std::abs(middle[kDamping]),
                         kLeastFriction * std::abs(middle[kCoulomb]), 0.01 * effort,
                         std::max(kLeastDelay_periods * t, kHidden * hidden.delay_s)};
  const auto found = intervals(middle, scatterOf(whole), partialEstimates(trace, whole), least);
  out.mass = found[kMass];
  out.damping = found[kDamping];
  out.coulomb = found[kCoulomb];
  out.gravity = found[kGravity];
  out.delay_s = found[kDelay];
  if (Diagnostics no = refusals(out, axis, t, effort); !no.empty()) return no;
  out.figures = refined(trace, out);
  return out;
}

}  // namespace wholehand
