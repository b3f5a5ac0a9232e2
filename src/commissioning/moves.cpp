#include "commissioning/moves.hpp"

#include "commissioning/identification/excitation.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

namespace wholehand {
namespace {

constexpr double kDampingRatio = 0.7;
constexpr double kFilter_s = 0.004;  // time constant of the speed filter
constexpr double kPush_s = 1.5;      // from zero to the allowed share
constexpr double kMoved = 0.02;      // share of the range that counts as motion
constexpr double kSweep = 0.04;      // amplitude, share of the range
constexpr double kSweep_s = 1.2;     // each way
constexpr double kDrive_s = 2.5;     // duration over the whole range
constexpr double kArrived = 0.02;    // of the range
constexpr double kArrive_s = 3.0;    // timeout at the end
constexpr double kIntegral_per_s = 3.0;
constexpr double kSmooth = 0.1;  // filter share per tick

double rangeOf(const DeviceAxis& axis) {
  return axis.upper - axis.lower;
}

Diagnostic refuse(const Bench& bench, std::size_t axis, const std::string& problem,
                  const std::string& remedy) {
  return {bench.model().path, 0, "axes", bench.model().axes[axis].name, problem, remedy};
}

}  // namespace

SoftHold::SoftHold(const Bench& bench, std::vector<double> offset)
    : bench_(&bench), offset_(std::move(offset)), speed_(offset_.size(), 0.0) {}

double SoftHold::effort(std::size_t axis, double target_speed) const {
  const double w = 2.0 * std::numbers::pi * kSpring_hz;
  const double mass = bench_->model().axes[axis].mass;
  return offset_[axis] + mass * w * w * (target[axis] - position_[axis]) +
         2.0 * kDampingRatio * mass * w * (target_speed - speed_[axis]);
}

void SoftHold::hold(Bench::Now& now) {
  if (target.empty()) target = now.position;
  if (last_.empty()) last_ = now.position;
  // A late tick's motion took longer.
  const double t = std::max(bench_->period_s(), now.taken_s - last_s_);
  last_s_ = now.taken_s;
  position_ = now.position;
  for (std::size_t i = 0; i < position_.size(); ++i) {
    speed_[i] = (kFilter_s * speed_[i] + (position_[i] - last_[i])) / (kFilter_s + t);
    now.effort[i] = effort(i);
  }
  last_ = position_;
}

Expected<Push> pushSlowly(Bench& bench, std::size_t axis, double sign) {
  std::vector<double> start;
  Push push;
  const auto done = bench.move(
      {Motion::What::kPush,
       fmt::format("axis {} is pushed in {} direction", bench.model().axes[axis].name,
                   sign > 0.0 ? '+' : '-'),
       bench.model().axes[axis].name, kPush_s},
      [&](Bench::Now& now) -> Expected<bool> {
        if (start.empty()) start = now.position;
        push.moved = 0.0;
        for (std::size_t i = 0; i < start.size(); ++i) {
          const double moved = (now.position[i] - start[i]) / rangeOf(bench.model().axes[i]);
          if (std::abs(moved) > std::abs(push.moved)) push.axis = i, push.moved = moved;
        }
        if (std::abs(push.moved) > kMoved) return false;
        push.share = kCommissioningShare * now.time_s / kPush_s;
        if (push.share > kCommissioningShare) {
          push.moved = 0.0;
          return false;
        }
        now.effort[axis] += sign * push.share * bench.model().axes[axis].effort_limit;
        return true;
      });
  if (!done) return done.errors();
  return push;
}

Expected<double> carryingEffort(Bench& bench, std::size_t axis, const std::vector<double>& offset) {
  SoftHold hold(bench, offset);
  double integral = 0.0, centre = 0.0;
  std::array<double, 2> sum{};
  std::array<int, 2> count{};
  const DeviceAxis& a = bench.model().axes[axis];
  const double reach = kSweep * rangeOf(a);
  const auto done = bench.move(
      {Motion::What::kCarry, "what carries axis " + a.name + " is measured", a.name,
       5.0 * kSweep_s},
      [&](Bench::Now& now) -> Expected<bool> {
        hold.hold(now);
        if (now.time_s == 0.0) {
          centre = std::clamp(now.position[axis], a.lower + 2.0 * reach, a.upper - 2.0 * reach);
        }
        // Settle, up, down, up, down; the second half of each leg is evaluated.
        const double legs = now.time_s / kSweep_s - 1.0;
        if (legs >= 4.0) return false;
        const int leg = static_cast<int>(std::floor(legs));
        const bool up = leg % 2 == 0;
        const double part = legs - leg;
        const double goal =
            centre + (leg < 0 ? -reach : (up ? 2.0 * part - 1.0 : 1.0 - 2.0 * part) * reach);
        const double wanted_speed = leg < 0 ? 0.0 : (up ? 2.0 : -2.0) * reach / kSweep_s;
        // Starts at the present position, without a jump.
        hold.target[axis] += (goal - hold.target[axis]) * std::min(1.0, bench.period_s() / 0.05);
        const double w = 2.0 * std::numbers::pi * kSpring_hz;
        integral += kIntegral_per_s * a.mass * w * w * (hold.target[axis] - now.position[axis]) *
                    bench.period_s();
        integral = std::clamp(integral, -bench.limit(axis), bench.limit(axis));
        const double effort = std::clamp(hold.effort(axis, wanted_speed) + integral,
                                         -bench.limit(axis), bench.limit(axis));
        now.effort[axis] = effort;
        if (leg >= 0 && part > 0.5) {
          sum.at(up ? 0 : 1) += effort;
          ++count.at(up ? 0 : 1);
        }
        return true;
      });
  if (!done) return done.errors();
  return 0.5 * (sum[0] / count[0] + sum[1] / count[1]);
}

Expected<Done> driveTo(Bench& bench, std::size_t axis, double position,
                       const std::vector<double>& offset) {
  SoftHold hold(bench, offset);
  double integral = 0.0, arrived_s = 0.0;
  const DeviceAxis& a = bench.model().axes[axis];
  return bench.move(
      {Motion::What::kDrive,
       fmt::format("axis {} is driven to {:.4g} {}", a.name, position, a.positionUnit()), a.name,
       0.0},
      [&](Bench::Now& now) -> Expected<bool> {
        hold.hold(now);
        const double speed = rangeOf(a) / kDrive_s, step = speed * bench.period_s();
        const double left = position - hold.target[axis];
        hold.target[axis] += std::clamp(left, -step, step);
        const double w = 2.0 * std::numbers::pi * kSpring_hz;
        integral += kIntegral_per_s * a.mass * w * w * (hold.target[axis] - now.position[axis]) *
                    bench.period_s();
        integral = std::clamp(integral, -0.5 * bench.limit(axis), 0.5 * bench.limit(axis));
        const double towards = std::abs(left) > step ? std::copysign(speed, left) : 0.0;
        now.effort[axis] = hold.effort(axis, towards) + integral;
        if (std::abs(now.position[axis] - position) < kArrived * rangeOf(a)) return false;
        if (std::abs(left) < step) arrived_s += bench.period_s();
        if (arrived_s < kArrive_s) return true;
        return refuse(bench, axis,
                      fmt::format("does not get to {:.4g} {}: it stops at {:.4g}", position,
                                  a.positionUnit(), now.position[axis]),
                      "state the range that it has, or clear its way");
      });
}

Expected<Excited> excite(Bench& bench, std::size_t axis, const std::vector<double>& offset,
                         double duration_s) {
  const DeviceAxis& a = bench.model().axes[axis];
  ExcitationPlan plan{bench.period_s(),  a.lower,      a.upper,   a.mass,
                      bench.limit(axis), offset[axis], duration_s};
  Excitation excitation(plan);
  SoftHold hold(bench, offset);
  Excited out;
  out.trace.period_s = bench.period_s();
  const std::size_t axes = offset.size();
  std::vector<double> before, filtered(axes, 0.0);
  out.response.assign(axes, 0.0);
  const auto done = bench.move(
      {Motion::What::kMeasure, fmt::format("axis {} is measured for {:.0f} s", a.name, duration_s),
       a.name, duration_s},
      [&](Bench::Now& now) -> Expected<bool> {
        hold.hold(now);
        if (!out.trace.position.empty()) out.trace.effort.push_back(bench.sent(axis));
        if (excitation.done()) return false;
        out.trace.posture.push_back(excitation.posture());
        now.effort[axis] = excitation.next(now.position[axis]);
        out.trace.position.push_back(now.position[axis]);
        out.taken_s.push_back(now.taken_s);
        if (before.empty()) before = now.position;
        // Uses acceleration, where inertial coupling is visible.
        for (std::size_t i = 0; i < axes; ++i) {
          const double change = kSmooth * (now.position[i] - before[i] - filtered[i]);
          filtered[i] += change;
          out.response[i] += bench.model().axes[i].mass * change * change;
        }
        before = now.position;
        return true;
      });
  if (!done) return done.errors();
  const double own = std::max(out.response[axis], 1e-300);
  for (double& r : out.response) r = std::sqrt(r / own);
  return out;
}

}  // namespace wholehand
