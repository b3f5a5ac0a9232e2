// Measurements and tests of each step of Commissioning.
#include "commissioning/commissioning.hpp"
#include "commissioning/identification/even_trace.hpp"
#include "commissioning/identification/identify_axis.hpp"
#include "commissioning/moves.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace wholehand {
namespace {

constexpr double kByHand = 0.05;  // share of the range that counts as moved by hand
constexpr double kOthers = 0.5;   // share of the pushed axis's motion
constexpr double kScaleWithin = 0.05;
constexpr double kWrapped = 0.25;     // share of the range between two samples
constexpr double kStopWithin = 0.02;  // share of the range
constexpr double kWeightWithin = 0.1;
constexpr double kCross = 0.1;
constexpr int kMostDelay_ticks = 8;  // largest value of a device file

// Meaning of the + direction for a person in front of the device.
std::string plus(const DeviceAxis& axis) {
  if (axis.name == "x") return "away from you";
  if (axis.name == "y") return "to your left";
  if (axis.name == "z") return "up";
  if (axis.group == AxisGroup::kHand) return "in its + direction (flexion: closing)";
  return "in its + direction (right-hand rule)";
}

std::vector<FoundFigure> measured(const DeviceAxis& axis, const PassportAxis& p) {
  const bool turns = axis.kind == AxisKind::kRotation;
  return {{axis.name, "mass", turns ? "kg·m²" : "kg", p.mass.lower, p.mass.upper},
          {axis.name, "damping", turns ? "N·m·s/rad" : "N·s/m", p.damping.lower, p.damping.upper},
          {axis.name, "dry-friction", axis.effortUnit(), p.coulomb.lower, p.coulomb.upper},
          {axis.name, "delay", "ms", 1e3 * p.delay_s.lower, 1e3 * p.delay_s.upper}};
}

}  // namespace

Expected<Done> Commissioning::pushAway(std::size_t i) {
  std::vector<double> first, last;
  const auto answer = bench_.askWhile(
      {Question::About::kPushAway,
       fmt::format("Push axis {} {} by about a tenth of its range, leave it there; Enter",
                   axis(i).name, plus(axis(i))),
       axis(i).name, axis(i).positionUnit(), 0.0, 0.0},
      [&](const std::vector<double>& position) {
        if (first.empty()) first = position;
        last = position;
      });
  if (!answer) return answer.errors();
  if (first.empty()) return no(i, "gave no sample", "look at its cable");
  std::vector<double> moved;
  for (std::size_t j = 0; j < axes(); ++j) {
    moved.push_back((last[j] - first[j]) / (axis(j).upper - axis(j).lower));
  }
  const std::size_t most =
      std::max_element(moved.begin(), moved.end(),
                       [](double a, double b) { return std::abs(a) < std::abs(b); }) -
      moved.begin();
  if (std::abs(moved[most]) < kByHand) {
    return no(i, "its position did not change while it was pushed",
              "push it further, or look at its encoder");
  }
  if (most != i && std::abs(moved[i]) < kOthers * std::abs(moved[most])) {
    return no(
        i,
        fmt::format("was pushed, but axis {} moved: their positions are swapped", axis(most).name),
        "name the axes as they are wired, and repeat the step");
  }
  if (moved[i] < 0.0) {
    return no(i,
              fmt::format("was pushed {}, and its position fell: its encoder has the wrong sign",
                          plus(axis(i))),
              "turn the sign of its position round in the driver, and repeat the step");
  }
  return Done{};
}

// Whether the axis follows its effort; false: nothing moves, as at a stop.
Expected<bool> Commissioning::movesWith(std::size_t i, double sign) {
  const auto push = pushSlowly(bench_, i, sign);
  if (!push) return push.errors();
  if (push->moved == 0.0) return false;
  if (push->axis != i) {
    return no(i,
              fmt::format("was given effort, but axis {} moved: their motors are swapped",
                          axis(push->axis).name),
              "wire or name them right, and repeat the step");
  }
  if (push->moved * sign < 0.0) {
    return no(i,
              fmt::format("moves in {} direction under {} effort: its motor has the wrong sign, or "
                          "its own weight moves it",
                          sign > 0.0 ? '-' : '+', sign > 0.0 ? '+' : '-'),
              "turn the sign of its effort round in the driver, or state in the device file what "
              "carries it, and repeat the step");
  }
  const double share_percent = 100.0 * push->share;
  tell(fmt::format("  {}: {} effort moves it {}, at {:.0f} % of its limit", axis(i).name,
                   sign > 0.0 ? '+' : '-', sign > 0.0 ? '+' : '-', share_percent),
       {{axis(i).name, sign > 0.0 ? "moves-at-plus" : "moves-at-minus", "%", share_percent,
         share_percent}});
  return true;
}

// Pushes both ways: an axis driven by its own weight would follow one of them whatever its motor
// does.
Expected<Done> Commissioning::motorSign(std::size_t i) {
  const auto up = movesWith(i, 1.0);
  if (!up) return up.errors();
  const auto down = movesWith(i, -1.0);
  if (!down) return down.errors();
  if (*up || *down) return Done{};
  return no(i, "nothing moves at a fifth of its effort limit",
            "look for a brake, a cable or a wrong effort limit");
}

Expected<Done> Commissioning::signs() {
  for (std::size_t i = 0; i < axes(); ++i) {
    if (auto by_hand = pushAway(i); !by_hand) return by_hand;
    if (auto motor = motorSign(i); !motor) return motor;
  }
  return Done{};
}

Expected<Done> Commissioning::moveBetweenStops(std::size_t i) {
  const DeviceAxis& a = axis(i);
  double least = HUGE_VAL, most = -HUGE_VAL, last = std::nan(""), jump = 0.0;
  const auto stated = askNumber(
      {Question::About::kTravel,
       fmt::format("Move axis {} slowly to its one stop, then to the other; measure how far that "
                   "is [{}]:",
                   a.name, a.positionUnit()),
       a.name, a.positionUnit(), 0.0, 0.0},
      [&](const std::vector<double>& position) {
        const double q = position[i];
        if (std::isfinite(last)) jump = std::max(jump, std::abs(q - last));
        last = q;
        least = std::min(least, q);
        most = std::max(most, q);
      });
  if (!stated) return stated.errors();
  const double range = a.upper - a.lower, moved = most - least;
  if (jump > kWrapped * range) {
    return no(i,
              fmt::format("its position jumped by {:.3g} {}: its encoder wraps round", jump,
                          a.positionUnit()),
              "let the driver count turns, and repeat the step");
  }
  if (std::abs(moved / *stated - 1.0) > kScaleWithin) {
    return no(i,
              fmt::format("moved {:.4g} {}, its encoder says {:.4g}: {:.3g} times", *stated,
                          a.positionUnit(), moved, moved / *stated),
              "set the scale of its position in the driver, and repeat the step");
  }
  if (moved < range * (1.0 - kStopWithin)) {
    return no(
        i, fmt::format("travels {:.4g} {}, the file states {:.4g}", moved, a.positionUnit(), range),
        "state the range that it has, or move it to both stops");
  }
  const double margin = kStopWithin * range;
  if (least > a.lower + margin || most < a.upper - margin) {
    return no(
        i,
        fmt::format("has its stops at {:.4g} and {:.4g} {}, the file states {:.4g} to {:.4g}: "
                    "it was homed elsewhere than where it stands",
                    least, most, a.positionUnit(), a.lower, a.upper),
        "home it anew, or state the range that it has");
  }
  tell(fmt::format("  {}: {:.4g} to {:.4g} {}", a.name, least, most, a.positionUnit()),
       {{a.name, "travel", a.positionUnit(), least, most}});
  return Done{};
}

Expected<Done> Commissioning::scaleAndTravel() {
  for (std::size_t i = 0; i < axes(); ++i) {
    if (auto good = moveBetweenStops(i); !good) return good;
  }
  return Done{};
}

Expected<Done> Commissioning::measure(std::size_t i) {
  // Starts between ends that leave room for the whole motion.
  const double middle = 0.5 * (axis(i).lower + axis(i).upper);
  if (auto there = driveTo(bench_, i, middle, offset_); !there) return there;
  const auto excited = excite(bench_, i, offset_, plan_.measure_s);
  if (!excited) return excited.errors();
  for (std::size_t j = 0; j < axes(); ++j) {
    if (j == i || excited->response[j] <= kCross) continue;
    return no(i,
              fmt::format("moves axis {} along: {:.0f} % of its own response, 10 % are allowed",
                          axis(j).name, 100.0 * excited->response[j]),
              "let the driver decouple the axes: efforts in coordinates in which the inertia is "
              "diagonal");
  }
  const auto even = evenTrace(excited->trace, excited->taken_s, axis(i).name);
  if (!even) return even.errors();
  const auto found = identifyAxis(*even, axis(i).name);
  if (!found) return found.errors();
  if (found->delay_s.upper > kMostDelay_ticks * bench_.period_s()) {
    return no(i,
              fmt::format("its delay is up to {:.4f} s: more than {} periods", found->delay_s.upper,
                          kMostDelay_ticks),
              "use a faster bus, or a lower rate");
  }
  PassportAxis& p = passport_.axes[i];
  p.mass = found->mass;
  p.damping = found->damping;
  p.coulomb = found->coulomb;
  p.gravity = found->gravity;
  p.delay_s = found->delay_s;
  p.resolution = found->resolution;
  tell(fmt::format("  {}: mass {:.4g} to {:.4g}, damping {:.4g} to {:.4g}, dry friction {:.4g} to "
                   "{:.4g}, delay {:.2f} to {:.2f} ms",
                   axis(i).name, p.mass.lower, p.mass.upper, p.damping.lower, p.damping.upper,
                   p.coulomb.lower, p.coulomb.upper, 1e3 * p.delay_s.lower, 1e3 * p.delay_s.upper),
       measured(axis(i), p));
  return Done{};
}

Expected<Done> Commissioning::massFrictionDelay() {
  for (std::size_t i = 0; i < axes(); ++i) {
    if (auto measured = measure(i); !measured) return measured;
  }
  return Done{};
}

Expected<Done> Commissioning::hang(std::size_t i) {
  const auto before = carryingEffort(bench_, i, offset_);
  if (!before) return before.errors();
  const double room = bench_.limit(i) - std::abs(*before) - passport_.axes[i].coulomb.upper;
  const auto force = askNumber(
      {Question::About::kKnownForce,
       fmt::format("Let a known force pull axis {} against its + direction, {:.2g} to {:.2g} {} (a "
                   "weight over a pulley); its force:",
                   axis(i).name, 0.25 * room, 0.6 * room, axis(i).effortUnit()),
       axis(i).name, axis(i).effortUnit(), 0.25 * room, 0.6 * room},
      [](const std::vector<double>&) {});
  if (!force) return force.errors();
  const auto with = carryingEffort(bench_, i, offset_);
  if (!with) return with.errors();
  const double found = *with - *before;
  if (std::abs(found / *force - 1.0) > kWeightWithin) {
    return no(i,
              fmt::format("carries {:.4g} {} with {:.4g}: its efforts are {:.3g} times what they "
                          "are called",
                          *force, axis(i).effortUnit(), found, *force / found),
              "set the torque constant in the driver, and begin again with mass-friction-delay");
  }
  tell(fmt::format("  {}: {:.4g} {} were carried with {:.4g}", axis(i).name, *force,
                   axis(i).effortUnit(), found),
       {{axis(i).name, "known-force", axis(i).effortUnit(), *force, *force},
        {axis(i).name, "carried-with", axis(i).effortUnit(), found, found}});
  return Done{};
}

Expected<Done> Commissioning::knownWeight() {
  for (std::size_t i = 0; i < axes(); ++i) {
    if (auto good = hang(i); !good) return good;
  }
  tell("Take the weight off.");
  return Done{};
}

Expected<Done> Commissioning::rangeStops() {
  for (std::size_t i = 0; i < axes(); ++i) {
    const DeviceAxis& a = axis(i);
    const double margin = kStopWithin * (a.upper - a.lower);
    for (const double end : {a.upper - margin, a.lower + margin, 0.5 * (a.lower + a.upper)}) {
      if (auto there = driveTo(bench_, i, end, offset_); !there) return there;
    }
  }
  return Done{};
}

}  // namespace wholehand
