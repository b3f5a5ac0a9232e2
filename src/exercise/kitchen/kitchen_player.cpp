#include "exercise/kitchen/kitchen_player.hpp"

#include "core/geometry.hpp"

#include <algorithm>
#include <cmath>

namespace wholehand::kitchen {
namespace {

// Postures [rad] and speeds, as in the bar's player.
constexpr double kHalfBent = 65.0 * kDeg, kClosed = 155.0 * kDeg;
// The fingers point sideways: they pass behind a bar that stands before a front.
constexpr double kHooked = 100.0 * kDeg;
constexpr double kTurnedAside = 5.0 * kDeg, kOpposed = 20.0 * kDeg, kThumbClosed = 27.0 * kDeg;
constexpr double kThumbAlong = kThumbClosed / (kClosed - kHalfBent);
constexpr double kBack_m = 0.006, kBeside_m = 0.09;
constexpr double kArm_m_s = 0.42, kFingers_rad_s = 4.0, kShortest_s = 0.3;
constexpr double kClosing_rad_s = 1.0, kFilter_s = 0.05;
// A thing is carried at this speed of the grip, with a grip of so much more than was asked.
constexpr double kCarry_m_s = 0.06, kFirmly = 2.0, kLeastGrip_n = 3.0;

BarLayout layoutOf(const KitchenTask& task, const DeviceModel& device, const HandModel& hand) {
  Bar one;
  BarDispenser& thing = one.dispensers.emplace_back();
  thing.body_index = task.things.front().body;
  thing.radius_m = task.things.front().radius_m;
  thing.grip_m = thing.nozzle_m = Eigen::Vector3d::Zero();
  return makeBarLayout(one, device, &hand);
}

}  // namespace

KitchenPlayer::KitchenPlayer(const KitchenTask& task, const DeviceModel& device,
                             const HandModel& hand, const PlayerTraits& traits)
    : task_(task),
      layout_(layoutOf(task, device, hand)),
      opening_rad_s_(traits.opening_rad_s),
      pace_(0.8 + 0.1 * static_cast<double>(traits.seed % 5)),
      start_(layout_.axes) {
  const auto put = [this](int axis, double value) {
    if (axis >= 0) start_[axis] = std::clamp(value, layout_.lower[axis], layout_.upper[axis]);
  };
  put(layout_.x, -0.07);
  put(layout_.fingers, kHalfBent);
  put(layout_.turn, kTurnedAside);
  KitchenPlayer::reset();
}

void KitchenPlayer::reset() {
  q_ = start_;
  qd_ = AxisVelocity(layout_.axes);
  advanced_ = lost_ = done_ = false;
  squeeze_n_ = rate_rad_s_ = joint_q_ = aim_q_ = 0.0;
  step_ = 0;
  go(Phase::kDrawBack);
}

/// Where the grip of the present step's thing is at q of its joint.
Eigen::Vector3d KitchenPlayer::gripAt(double q) const noexcept {
  const Step& step = task_.steps[std::min<std::size_t>(step_, task_.steps.size() - 1)];
  const Thing& thing = task_.things[step.thing];
  if (!thing.jointed) return grip_m_;
  return poseOn(thing.joint, thing.start, q) * (thing.grip_m + thing.com_m);
}

AxisPosition KitchenPlayer::goalOf(Phase phase) const noexcept {
  AxisPosition goal = q_;
  const auto put = [&](int axis, double value) {
    if (axis >= 0) goal[axis] = std::clamp(value, layout_.lower[axis], layout_.upper[axis]);
  };
  const auto hand = [&](double fingers, double turn) {
    put(layout_.fingers, fingers);
    put(layout_.turn, turn);
    put(layout_.thumb, 0.0);
  };
  const auto base = [&](double x_m, double y_m, double z_m) {
    put(layout_.x, x_m);
    put(layout_.y, y_m);
    put(layout_.z, z_m);
  };
  const Eigen::Vector3d at_m = grip_m_ - layout_.grip_m;
  const double back_m = layout_.x >= 0 ? layout_.lower[layout_.x] + kBack_m : 0.0;
  const double beside_m = at_m.y() - layout_.beside * kBeside_m;
  switch (phase) {
    case Phase::kDrawBack:
    case Phase::kRest:
      put(layout_.x, back_m);
      hand(kHalfBent, kTurnedAside);
      break;
    case Phase::kAlign:
      base(back_m, beside_m, at_m.z());
      hand(kHooked, kTurnedAside);
      break;
    case Phase::kEnter:
    case Phase::kLeave:
      base(at_m.x(), beside_m, at_m.z());
      hand(kHooked, kTurnedAside);
      break;
    case Phase::kTouch:
      base(at_m.x(), at_m.y(), at_m.z());
      hand(kHooked, kOpposed);
      break;
    case Phase::kOpen:
      base(at_m.x(), at_m.y(), at_m.z());
      hand(kHooked, kTurnedAside);
      break;
    case Phase::kClose:
    case Phase::kCarry:
      break;
  }
  return goal;
}

void KitchenPlayer::go(Phase phase) noexcept {
  phase_ = phase;
  rate_rad_s_ = 0.0;
  if (phase == Phase::kCarry) aim_q_ = joint_q_;
  const AxisPosition goal = goalOf(phase);
  double longest_s = kShortest_s;
  for (int i = 0; i < goal.size(); ++i) {
    const bool arm = i == layout_.x || i == layout_.y || i == layout_.z;
    const double peak = arm ? kArm_m_s : kFingers_rad_s;
    longest_s = std::max(longest_s, kMinimumJerkPeak * std::abs(goal[i] - q_[i]) / peak);
  }
  reach_.begin(q_, qd_, goal, longest_s / pace_);
  if (phase == Phase::kTouch && layout_.y >= 0) reach_.during(layout_.y, 0.0, 0.7);
  if (phase == Phase::kTouch && layout_.fingers >= 0) reach_.during(layout_.fingers, 0.2, 1.0);
  for (const int axis : {layout_.fingers, layout_.thumb, layout_.turn}) {
    if (axis >= 0 && goal[axis] < q_[axis]) reach_.limitSpeed(axis, opening_rad_s_);
  }
}

void KitchenPlayer::advance(double period_s, AxisPosition& q, AxisVelocity& qd) noexcept {
  advanced_ = true;
  if (lost_) {  // continues from the hand's present pose
    lost_ = false;
    go(Phase::kOpen);
  }
  if (phase_ == Phase::kClose || phase_ == Phase::kCarry) {
    close(period_s);
    if (phase_ == Phase::kCarry) carry(period_s);
  } else {
    reach_.advance(period_s, q_, qd_);
  }
  q = q_;
  qd = qd_;
}

// Closes until the grip is firm, and keeps it.
void KitchenPlayer::close(double period_s) noexcept {
  for (int a = 0; a < qd_.size(); ++a) qd_[a] = 0.0;
  if (layout_.fingers < 0) return;
  double asked_n = kLeastGrip_n;
  for (const Step& step : task_.steps) {
    if (step.verb == Verb::kTake) asked_n = std::max(asked_n, kFirmly * step.force_n);
  }
  const double lower = kHooked, upper = layout_.upper[layout_.fingers];
  const double fingers = q_[layout_.fingers];
  double wanted_rad_s =
      std::clamp(kClosing_rad_s * (asked_n - squeeze_n_) / asked_n, -0.2, kClosing_rad_s);
  wanted_rad_s = pace_ * std::clamp(wanted_rad_s, (lower - fingers) / 0.2, (upper - fingers) / 0.2);
  wanted_rad_s = std::max(wanted_rad_s, -opening_rad_s_);
  rate_rad_s_ += (wanted_rad_s - rate_rad_s_) * std::min(period_s / kFilter_s, 1.0);
  q_[layout_.fingers] = fingers + rate_rad_s_ * period_s;
  qd_[layout_.fingers] = rate_rad_s_;
  if (layout_.thumb < 0) return;
  q_[layout_.thumb] = std::clamp(q_[layout_.thumb] + kThumbAlong * rate_rad_s_ * period_s,
                                 layout_.lower[layout_.thumb], layout_.upper[layout_.thumb]);
  qd_[layout_.thumb] = kThumbAlong * rate_rad_s_;
}

// Leads the grip along its joint's path: the hand goes on ahead until the thing is where it is
// wanted, since friction and the arm's softness hold it back.
void KitchenPlayer::carry(double period_s) noexcept {
  const Step& step = task_.steps[std::min<std::size_t>(step_, task_.steps.size() - 1)];
  if (step.verb != Verb::kMove && step.verb != Verb::kHold) return;
  const double way_m = std::max(1e-3, (gripAt(aim_q_ + 1e-3) - gripAt(aim_q_)).norm() / 1e-3);
  const double missing = step.to - joint_q_;
  const double rate = std::clamp(3.0 * missing, -kCarry_m_s / way_m, kCarry_m_s / way_m);
  if (std::abs(missing) > 0.2 * step.tolerance) aim_q_ += pace_ * rate * period_s;
  moveBaseTo(gripAt(aim_q_) + aside_m_, period_s);
}

void KitchenPlayer::moveBaseTo(const Eigen::Vector3d& base_m, double period_s) noexcept {
  const int axes[] = {layout_.x, layout_.y, layout_.z};
  for (int k = 0; k < 3; ++k) {
    const int axis = axes[k];
    if (axis < 0) continue;
    const double most_m = kArm_m_s * period_s;
    const double to = std::clamp(base_m[k], layout_.lower[axis], layout_.upper[axis]);
    const double by = std::clamp(to - q_[axis], -most_m, most_m);
    q_[axis] += by;
    qd_[axis] = by / period_s;
  }
}

void KitchenPlayer::see(const TickRecord& record) noexcept {
  if (!advanced_ && record.intention.size() == layout_.axes) {  // someone else steered the hand
    lost_ = true;
    q_ = record.intention;
    qd_ = AxisVelocity(layout_.axes);
  }
  advanced_ = false;
  const ExerciseRecord& reported = record.exercise;
  if (reported.value_count != kValues) return;  // no values on the way to neutral
  done_ = reported.values[kDone] > 0.5;
  step_ = static_cast<int>(reported.values[kStep]);
  squeeze_n_ = reported.values[kSqueeze];
  joint_q_ = reported.values[kJoint];
  const Step& step = task_.steps[std::min<std::size_t>(step_, task_.steps.size() - 1)];
  const Thing& thing = task_.things[step.thing];
  grip_m_ = worldPoint(record.bodies[thing.body], thing.grip_m);
  if (!lost_) next();
}

/// The next phase, where this one is over.
void KitchenPlayer::next() noexcept {
  const Step& step = task_.steps[std::min<std::size_t>(step_, task_.steps.size() - 1)];
  const bool lets_go = done_ || step.verb == Verb::kLetGo || step.verb == Verb::kReach;
  const bool held = phase_ == Phase::kClose || phase_ == Phase::kCarry;
  if (held && lets_go) return go(Phase::kOpen);
  if (phase_ == Phase::kClose && step.verb != Verb::kTake) {
    aside_m_ = Eigen::Vector3d::Zero();
    const int axes[] = {layout_.x, layout_.y, layout_.z};
    for (int k = 0; k < 3; ++k) {
      if (axes[k] >= 0) aside_m_[k] = q_[axes[k]] - grip_m_[k];
    }
    return go(Phase::kCarry);
  }
  if (held || !reach_.done()) return;
  switch (phase_) {
    case Phase::kRest:
      if (!done_) go(Phase::kDrawBack);
      break;
    case Phase::kTouch:
      go(Phase::kClose);
      break;
    case Phase::kLeave:
      go(Phase::kRest);
      break;
    default:
      go(static_cast<Phase>(static_cast<int>(phase_) + 1));
  }
}

}  // namespace wholehand::kitchen
