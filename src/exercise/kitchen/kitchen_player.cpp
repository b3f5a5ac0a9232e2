#include "exercise/kitchen/kitchen_player.hpp"

#include "core/geometry.hpp"

#include <algorithm>
#include <cmath>

namespace wholehand::kitchen {
namespace {

using Eigen::Vector3d;

// Postures [rad] and speeds, as in the bar's player.
constexpr double kStraight = 0.0, kHalfBent = 65.0 * kDeg, kClosed = 155.0 * kDeg;
// The fingers point sideways: they pass behind a bar that stands before a front.
constexpr double kHooked = 100.0 * kDeg;
constexpr double kTurnedAside = 5.0 * kDeg, kOpposed = 20.0 * kDeg, kThumbClosed = 27.0 * kDeg;
constexpr double kThumbAlong = kThumbClosed / (kClosed - kHalfBent);
constexpr double kBack_m = 0.006, kBeside_m = 0.09, kBefore_m = 0.05, kGently_m = 0.01;
constexpr double kArm_m_s = 0.42, kFingers_rad_s = 4.0, kShortest_s = 0.3;
constexpr double kClosing_rad_s = 1.0, kFilter_s = 0.05;
// A thing is carried at this speed of the grip, with a force of so much more than was asked.
constexpr double kCarry_m_s = 0.06, kFirmly = 2.0, kLeastGrip_n = 3.0;
// The intention is ahead of what it carries by at most so much; further where nothing is felt yet.
constexpr double kAhead_m = 0.05, kSearch_m = 0.15, kFelt_n = 0.02;
constexpr double kNear_m = 0.01, kBend_rad = 0.2, kPush_m_s = 0.15;
// Share of the fingers' posture that is new with each record.
constexpr double kSeen = 0.01;
// While it is not yet gripped the hand follows a thing that gives way.
constexpr double kLoose_n = 0.3, kFollow_m_s = 0.05;
// Who has felt nothing for so long begins anew.
constexpr double kPatience_s = 2.0;

BarLayout layoutOf(const KitchenTask& task, const DeviceModel& device, const HandModel& hand) {
  Bar one;
  BarDispenser& thing = one.dispensers.emplace_back();
  thing.body_index = task.things.front().body;
  thing.grip_m = thing.nozzle_m = Vector3d::Zero();
  return makeBarLayout(one, device, &hand);
}

}  // namespace

KitchenPlayer::KitchenPlayer(const KitchenTask& task, const DeviceModel& device,
                             const HandModel& hand, const PlayerTraits& traits)
    : task_(task),
      layout_(layoutOf(task, device, hand)),
      fingertips_(hand, layout_.fingers),
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
  squeeze_n_ = handle_n_ = rate_rad_s_ = idle_s_ = joint_q_ = aim_q_ = 0.0;
  flexion_rad_ = kHalfBent;
  step_ = met_ = 0;
  meeting_ = Meeting{};
  go(Phase::kDrawBack);
}

const Step& KitchenPlayer::now() const noexcept {
  return task_.steps[std::min<std::size_t>(step_, task_.steps.size() - 1)];
}

bool KitchenPlayer::isHeld() const noexcept {
  return phase_ == Phase::kClose || phase_ == Phase::kCarry;
}

/// Decides how the present step's thing is met.
void KitchenPlayer::meet() noexcept {
  met_ = now().thing;
  meeting_ = meetingOf(task_, step_, joint_q_, bodies_[met_].position_m.eigen(), layout_.beside);
  clear_m_ = meeting_.means == Means::kPush
                 ? Vector3d(-kBefore_m * meeting_.toward)
                 : Vector3d(-layout_.beside * kBeside_m * Vector3d::UnitY());
}

/// The base from the point where a thing is met.
Vector3d KitchenPlayer::baseFrom(const Meeting& meeting, const Thing& thing,
                                 double flexion_rad) const noexcept {
  if (meeting.means == Means::kPush) return -fingertips_.foremost(meeting.toward, flexion_rad);
  return -layout_.grip_m - layout_.beside * thing.radius_m * Vector3d::UnitY();
}

KitchenPlayer::Met KitchenPlayer::metAt(int step, double q,
                                        const Vector3d& center_m) const noexcept {
  const std::size_t at = std::min<std::size_t>(step, task_.steps.size() - 1);
  const Meeting meeting = meetingOf(task_, step, q, center_m, layout_.beside);
  return {meeting, baseFrom(meeting, task_.things[task_.steps[at].thing], kStraight)};
}

/// The same now. Fingers may be more bent than their owner wants.
Vector3d KitchenPlayer::baseFromPoint(double flexion_rad) const noexcept {
  return baseFrom(meeting_, task_.things[met_], flexion_rad);
}

/// As pointAt() at an intended q, which may be ahead of the thing's: far along a path that turns it
/// leads straight on.
Vector3d KitchenPlayer::pointAhead(double q) const noexcept {
  const Thing& thing = task_.things[met_];
  if (!thing.jointed || !thing.joint.isHinge()) return pointAt(q);
  const double near = std::clamp(q, joint_q_ - kBend_rad, joint_q_ + kBend_rad);
  constexpr double kStep = 1e-3;
  return pointAt(near) + (q - near) / kStep * (pointAt(near + kStep) - pointAt(near));
}

/// Where the thing is met, now.
Vector3d KitchenPlayer::pointMet() const noexcept {
  return worldPoint(bodies_[met_], task_.things[met_].grip_m + meeting_.side_m);
}

/// The same at q of its joint; without one so far along its way [m].
Vector3d KitchenPlayer::pointAt(double q) const noexcept {
  const Thing& thing = task_.things[met_];
  if (thing.jointed) {
    return poseOn(thing.joint, thing.start, q) * (thing.grip_m + thing.com_m + meeting_.side_m);
  }
  return free_from_m_ + q * free_way_;
}

Vector3d KitchenPlayer::baseNow() const noexcept {
  Vector3d base_m = Vector3d::Zero();
  const int axes[] = {layout_.x, layout_.y, layout_.z};
  for (int k = 0; k < 3; ++k) {
    if (axes[k] >= 0) base_m[k] = q_[axes[k]];
  }
  return base_m;
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
  const auto base = [&](const Vector3d& base_m) {
    put(layout_.x, base_m.x());
    put(layout_.y, base_m.y());
    put(layout_.z, base_m.z());
  };
  const bool pushes = meeting_.means == Means::kPush;
  const double back_m = layout_.x >= 0 ? layout_.lower[layout_.x] + kBack_m : 0.0;
  const double open = pushes ? kStraight : kHooked;
  const double flexion_rad = phase == Phase::kAlign ? kStraight : flexion_rad_;
  const Vector3d at_m = pointMet() + baseFromPoint(flexion_rad), clear_m = at_m + clear_m_;
  switch (phase) {
    case Phase::kDrawBack:
    case Phase::kRest:
      put(layout_.x, back_m);
      hand(kHalfBent, kTurnedAside);
      break;
    case Phase::kAlign:
      base({back_m, clear_m.y(), clear_m.z()});
      hand(open, kTurnedAside);
      break;
    case Phase::kEnter:
    case Phase::kLeave:
      base(clear_m);
      hand(open, kTurnedAside);
      break;
    case Phase::kTouch:
      base(pushes ? Vector3d(at_m - kGently_m * meeting_.toward) : at_m);
      hand(open, pushes ? kTurnedAside : kOpposed);
      break;
    case Phase::kOpen:
      base(pushes ? clear_m : at_m);
      hand(open, kTurnedAside);
      break;
    case Phase::kClose:
    case Phase::kCarry:
      break;
  }
  return goal;
}

void KitchenPlayer::go(Phase phase) noexcept {
  phase_ = phase;
  rate_rad_s_ = idle_s_ = 0.0;
  if (phase == Phase::kAlign) meet();
  if (phase == Phase::kCarry) {
    const Vector3d way_m = now().center_m - bodies_[met_].position_m.eigen();
    free_from_m_ = pointMet();
    free_way_ = now().verb == Verb::kPut ? Vector3d(way_m.normalized()) : meeting_.toward;
    aim_q_ = task_.things[met_].jointed ? joint_q_ : 0.0;
    aside_m_ = baseNow() - pointMet();
  }
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
  if (isHeld()) {
    idle_s_ = handle_n_ < kFelt_n ? idle_s_ + period_s : 0.0;
    const AxisPosition before = q_;
    if (meeting_.means != Means::kPush) close(period_s);
    if (phase_ == Phase::kCarry) {
      carry(period_s);
    } else if (squeeze_n_ < kLoose_n && meeting_.means == Means::kGrasp) {
      moveBaseTo(pointMet() + baseFromPoint(flexion_rad_),
                 kFollow_m_s * period_s);  // it may have given way
    }
    for (int a = 0; a < qd_.size(); ++a) qd_[a] = (q_[a] - before[a]) / period_s;
  } else {
    reach_.advance(period_s, q_, qd_);
  }
  q = q_;
  qd = qd_;
}

/// How fast the hand closes, -1 .. 1 of its speed: until the grip is firm; a thing that is squeezed
/// follows to where it is wanted.
double KitchenPlayer::closing() const noexcept {
  if (meeting_.means == Means::kSqueeze) return meeting_.sign * hurry();
  double asked_n = kLeastGrip_n;
  for (const Step& each : task_.steps) {
    if (each.verb == Verb::kTake) asked_n = std::max(asked_n, kFirmly * each.force_n);
  }
  return (asked_n - squeeze_n_) / asked_n;
}

/// How fast q is to change, -1 .. 1 of the speed, and in which sense; 0: not at all.
double KitchenPlayer::hurry() const noexcept {
  const Step& step = now();
  if (step.verb == Verb::kPress) {
    const double asked_n = kFirmly * step.force_n;
    return meeting_.sign * std::clamp((asked_n - handle_n_) / asked_n, -1.0, 1.0);
  }
  if (step.verb == Verb::kPut) {
    const Vector3d way_m = step.center_m - bodies_[met_].position_m.eigen();
    return std::clamp(way_m.dot(free_way_) / kNear_m, -1.0, 1.0);
  }
  if (step.verb != Verb::kMove && step.verb != Verb::kHold) return 0.0;
  const double missing = step.to - joint_q_;
  if (std::abs(missing) <= 0.2 * step.tolerance) return 0.0;
  return std::clamp(missing / (2.0 * step.tolerance), -1.0, 1.0);
}

void KitchenPlayer::close(double period_s) noexcept {
  if (layout_.fingers < 0) return;
  const double lower = kHooked, upper = layout_.upper[layout_.fingers];
  const double fingers = q_[layout_.fingers];
  double wanted_rad_s = std::clamp(kClosing_rad_s * closing(), -0.2, kClosing_rad_s);
  wanted_rad_s = pace_ * std::clamp(wanted_rad_s, (lower - fingers) / 0.2, (upper - fingers) / 0.2);
  wanted_rad_s = std::max(wanted_rad_s, -opening_rad_s_);
  rate_rad_s_ += (wanted_rad_s - rate_rad_s_) * std::min(period_s / kFilter_s, 1.0);
  q_[layout_.fingers] = fingers + rate_rad_s_ * period_s;
  if (layout_.thumb < 0) return;
  q_[layout_.thumb] = std::clamp(q_[layout_.thumb] + kThumbAlong * rate_rad_s_ * period_s,
                                 layout_.lower[layout_.thumb], layout_.upper[layout_.thumb]);
}

// Leads the thing along its joint's path: the hand goes on ahead until the thing is where it is
// wanted, since friction and the arm's softness hold it back.
void KitchenPlayer::carry(double period_s) noexcept {
  const bool jointed = task_.things[met_].jointed;
  const double way_m =
      jointed ? std::max(1e-3, (pointAt(aim_q_ + 1e-3) - pointAt(aim_q_)).norm() / 1e-3) : 1.0;
  const double rate = pace_ * hurry() * kCarry_m_s / way_m;
  const double ahead = (handle_n_ < kFelt_n ? kSearch_m : kAhead_m) / way_m;
  const double from = jointed ? joint_q_ : free_way_.dot(pointMet() - free_from_m_);
  const double next = aim_q_ + rate * period_s;
  if (std::abs(next - from) < std::max(ahead, std::abs(aim_q_ - from))) aim_q_ = next;
  const bool pushes = meeting_.means == Means::kPush;
  const Vector3d base_m = pushes ? baseFromPoint(flexion_rad_) : aside_m_;
  moveBaseTo(pointAhead(aim_q_) + base_m, (pushes ? kPush_m_s : kArm_m_s) * period_s);
}

/// Moves the base towards a place, by so much along each axis at most.
void KitchenPlayer::moveBaseTo(const Vector3d& base_m, double most_m) noexcept {
  const int axes[] = {layout_.x, layout_.y, layout_.z};
  for (int k = 0; k < 3; ++k) {
    const int axis = axes[k];
    if (axis < 0) continue;
    const double to = std::clamp(base_m[k], layout_.lower[axis], layout_.upper[axis]);
    const double by = std::clamp(to - q_[axis], -most_m, most_m);
    q_[axis] += by;
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
  handle_n_ = reported.values[kHandle];
  joint_q_ = reported.values[kJoint];
  if (layout_.fingers >= 0) flexion_rad_ += kSeen * (record.q_s[layout_.fingers] - flexion_rad_);
  for (std::size_t i = 0; i < task_.things.size(); ++i) {
    bodies_[i] = record.bodies[task_.things[i].body];
  }
  if (!lost_) next();
}

/// The next phase, where this one is over.
void KitchenPlayer::next() noexcept {
  const Verb verb = now().verb;
  const bool lets_go = done_ || verb == Verb::kLetGo || verb == Verb::kReach ||
                       now().thing != met_ || idle_s_ > kPatience_s;
  if (isHeld() && lets_go) return go(Phase::kOpen);
  const bool grasps = meeting_.means == Means::kGrasp;
  if (phase_ == Phase::kClose && grasps && verb != Verb::kTake) return go(Phase::kCarry);
  if (isHeld() || !reach_.done()) return;
  switch (phase_) {
    case Phase::kRest:
      if (!done_) go(Phase::kDrawBack);
      break;
    case Phase::kTouch:
      go(meeting_.means == Means::kPush ? Phase::kCarry : Phase::kClose);
      break;
    case Phase::kLeave:
      go(Phase::kRest);
      break;
    default:
      go(static_cast<Phase>(static_cast<int>(phase_) + 1));
  }
}

}  // namespace wholehand::kitchen
