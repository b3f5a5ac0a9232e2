#include "devices/commissioning/climb.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>

namespace wholehand {
namespace {

constexpr double kGainWithin = 1.3, kApartWithin = 0.25, kAlongWithin = 0.2;
constexpr double kOfSpeedLimit = 0.4, kOfWholeRange = 0.1, kLongest_s = 0.15;
constexpr double kRest_s = 0.4;       // held by the spring before each push
constexpr double kAfter_s = 0.02;     // seen after a push
constexpr double kShownSteps = 15.0;  // encoder steps below which a motion shows nothing
constexpr int kSubsteps = 10;

// Peak of the speed, the displacement and the slope of a push of peak 1, length 1 and mass 1.
constexpr double kSpeed = 0.6495 / (2.0 * std::numbers::pi);
constexpr double kWay = 1.0 / (4.0 * std::numbers::pi * std::numbers::pi);
constexpr double kSlope = 1.37 * 2.0 * std::numbers::pi;

}  // namespace

double pushLength_s(const DeviceAxis& axis, double mass) {
  const double acceleration = axis.effort_limit / mass;
  const double by_speed = kOfSpeedLimit * axis.speed_limit / (kSpeed * acceleration);
  const double by_range =
      std::sqrt(kOfWholeRange * (axis.upper - axis.lower) / (kWay * acceleration));
  const double by_slew = 1.2 * kSlope * axis.effort_limit / axis.effort_slew_limit;
  return std::max(by_slew, std::min({by_speed, by_range, kLongest_s}));
}

double pushShape(double u) {
  const double turn = 2.0 * std::numbers::pi * u;
  return u <= 0.0 || u >= 1.0 ? 0.0 : -0.5 * (std::cos(turn) - std::cos(2.0 * turn));
}

PushResponse comparePush(const std::vector<double>& position, const std::vector<double>& effort,
                         double period_s, const ClimbedAxis& measured) {
  const double h = period_s / kSubsteps;
  double q = 0.0, v = 0.0, both = 0.0, own = 0.0, all = 0.0;
  for (std::size_t k = 0; k < position.size(); ++k) {
    const double moved = position[k] - position.front();
    both += q * moved;
    own += q * q;
    all += moved * moved;
    for (int j = 0; j < kSubsteps; ++j) {
      const double at = static_cast<double>(k) + ((j + 0.5) * h - measured.delay_s) / period_s;
      const double sent = at < 0.0 ? 0.0 : effort[static_cast<std::size_t>(at)];
      const double next = v + h * (sent - measured.damping * v) / measured.mass;
      const double rubs = h * measured.coulomb / measured.mass;
      v = std::abs(next) <= rubs ? 0.0 : next - std::copysign(rubs, next);
      q += h * v;
    }
  }
  PushResponse out;
  if (own <= 0.0) return out;
  out.gain = both / own;
  out.apart = std::sqrt(std::max(0.0, all / own - out.gain * out.gain));
  return out;
}

namespace {

/// Pushes once, after a rest. Positions and efforts begin with the push.
class OnePush {
 public:
  OnePush(Bench& bench, std::size_t axis, double peak, double length_s,
          const std::vector<double>& offset)
      : bench_(bench),
        axis_(axis),
        peak_(peak),
        length_s_(length_s),
        offset_(offset),
        hold_(bench, offset) {}

  Expected<bool> operator()(Bench::Now& now) {
    hold_.hold(now);
    if (!position.empty()) effort.push_back(bench_.sent(axis_) - offset_[axis_]);
    const double since_s = now.time_s - kRest_s;
    if (since_s < 0.0) return true;
    if (start_.empty()) start_ = farthest_ = now.position;
    for (std::size_t j = 0; j < start_.size(); ++j) {
      const double way = std::abs(now.position[j] - start_[j]);
      if (way > std::abs(farthest_[j] - start_[j])) farthest_[j] = now.position[j];
    }
    position.push_back(now.position[axis_]);
    now.effort[axis_] = offset_[axis_] + peak_ * pushShape(since_s / length_s_);
    return since_s < length_s_ + kAfter_s;
  }
  /// Farthest distance of each axis from where the push began [m or rad].
  [[nodiscard]] double way(std::size_t j) const { return std::abs(farthest_[j] - start_[j]); }

  std::vector<double> position, effort;

 private:
  Bench& bench_;
  std::size_t axis_;
  double peak_, length_s_;
  const std::vector<double>& offset_;
  SoftHold hold_;
  std::vector<double> start_, farthest_;
};

Diagnostic disagrees(const Bench& bench, std::size_t axis, double share, const std::string& how) {
  return {bench.model().path,
          0,
          "axes",
          bench.model().axes[axis].name,
          fmt::format("at {:.0f} % of its effort limit {}", 100.0 * share, how),
          "have the drive looked at: its limits of current, its signs, its supply; then measure "
          "again"};
}

Expected<Done> judge(const Bench& bench, std::size_t axis, double share, const OnePush& push,
                     const PushResponse& seen) {
  const std::vector<DeviceAxis>& axes = bench.model().axes;
  const double own = push.way(axis) * std::sqrt(axes[axis].mass);
  for (std::size_t j = 0; j < axes.size(); ++j) {
    const double way = push.way(j) - kShownSteps * axes[j].encoder_step;
    if (j == axis || way * std::sqrt(axes[j].mass) <= kAlongWithin * own) continue;
    return disagrees(bench, axis, share, fmt::format("it moves axis {} along", axes[j].name));
  }
  if (push.way(axis) < kShownSteps * axes[axis].encoder_step) {
    return disagrees(bench, axis, share, "it does not move");
  }
  if (seen.gain < 1.0 / kGainWithin || seen.gain > kGainWithin) {
    return disagrees(bench, axis, share,
                     fmt::format("it moves as with {:.3g} times its effort", seen.gain));
  }
  if (seen.apart > kApartWithin) {
    return disagrees(bench, axis, share,
                     fmt::format("its motion differs by {:.0f} % from what its mass, friction and "
                                 "delay give",
                                 100.0 * seen.apart));
  }
  return Done{};
}

}  // namespace

Expected<double> climb(Bench& bench, std::size_t axis, const ClimbedAxis& measured,
                       const std::vector<double>& offset) {
  const DeviceAxis& a = bench.model().axes[axis];
  const double length_s = pushLength_s(a, measured.mass);
  double reached = 0.0;
  for (const double share : kClimbShares) {
    for (const double way : {1.0, -1.0}) {
      const double peak = way * (share * a.effort_limit - std::abs(offset[axis]));
      OnePush push(bench, axis, peak, length_s, offset);
      const Motion motion{
          MotionKind::kMeasure,
          fmt::format("axis {} is pushed with {:.0f} % of its effort limit", a.name, 100.0 * share),
          a.name, kRest_s + length_s};
      const ShareInForce in_force(bench, share);
      const auto pushed =
          bench.move(motion, [&](Bench::Now& now) -> Expected<bool> { return push(now); });
      if (!pushed) return pushed.errors();
      push.effort.resize(push.position.size(), 0.0);
      const auto agreed =
          judge(bench, axis, share, push,
                comparePush(push.position, push.effort, bench.period_s(), measured));
      if (!agreed) return agreed.errors();
    }
    reached = share;
  }
  return reached;
}

}  // namespace wholehand
