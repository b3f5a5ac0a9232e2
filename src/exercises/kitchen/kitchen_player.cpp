#include "exercises/kitchen/kitchen_player.hpp"

#include "exercises/approach.hpp"
#include "exercises/player_reach.hpp"
#include "loop/dynamics/articulated_body.hpp"
#include "loop/dynamics/synergy.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

namespace wholehand::kitchen {
namespace {

using Eigen::Vector3d;

bool movesThing(Verb verb) noexcept {
  return verb == Verb::kMove || verb == Verb::kHold || verb == Verb::kPress || verb == Verb::kPut;
}

/// Sign of the change of q that a step requires. A press goes towards the end that still has
/// travel.
double signOf(const Step& step, const Thing& thing, double q) noexcept {
  if (step.verb == Verb::kPress) return thing.joint.most > q ? 1.0 : -1.0;
  return step.to < q ? -1.0 : 1.0;
}

/// The coordinate axis nearest to a direction.
Vector3d nearestAxis(const Vector3d& direction) noexcept {
  int k = 0;
  direction.cwiseAbs().maxCoeff(&k);
  return std::copysign(1.0, direction[k]) * Vector3d::Unit(k);
}

/// Chooses the means from the required direction of motion of the contact point.
void decide(const Vector3d& direction, double beside, Meeting& out) noexcept {
  out.toward = nearestAxis(direction);
  if (out.toward.x() < -0.5) {
    out.means = Means::kGrasp;  // only a closed hand can pull
  } else if (beside * out.toward.y() < -0.5) {
    out.means = Means::kSqueeze;
  } else {
    out.means = Means::kPush;
  }
}

void meetOnJoint(const Thing& thing, double q, double beside, Meeting& out) noexcept {
  const Pose pose = poseOn(thing.joint, thing.start, q);
  const Vector3d axis = pose.rotation * thing.joint.axis;
  if (!thing.joint.isHinge()) return decide(out.sign * axis, beside, out);
  const Vector3d arm_m = pose * (thing.grip_m + thing.com_m) - pose * thing.joint.point_m;
  const Vector3d way_m = axis.cross(arm_m);
  if (way_m.norm() > thing.radius_m) return decide(out.sign * way_m, beside, out);
  const Vector3d away = Vector3d::UnitX(), lateral = out.sign * away.cross(axis);
  if (lateral.norm() < 0.5) return;  // a knob that faces the person is grasped
  out.means = Means::kPush;
  out.toward = away;
  out.side_m = pose.rotation.transpose() * (thing.radius_m * lateral.normalized());
}

}  // namespace

Meeting meetingOf(const KitchenTask& task, int step, double q, const Vector3d& center_m,
                  double beside) noexcept {
  const int count = static_cast<int>(task.steps.size()), now = std::min(step, count - 1);
  int first = now;
  while (first > 0 && task.steps[first - 1].verb != Verb::kLetGo) --first;
  const Step* aim = nullptr;
  for (int i = first; i < count; ++i) {
    const Step& s = task.steps[i];
    if (s.verb == Verb::kTake) return {};
    if (i >= now && aim == nullptr && movesThing(s.verb)) aim = &s;
    if (s.verb == Verb::kLetGo) break;
  }
  Meeting out;
  if (aim == nullptr) return out;
  const Thing& thing = task.things[aim->thing];
  if (thing.jointed) {
    out.sign = signOf(*aim, thing, q);
    meetOnJoint(thing, q, beside, out);
  } else {
    const bool put = aim->verb == Verb::kPut;
    decide(put ? Vector3d(aim->center_m - center_m) : Vector3d::UnitX(), beside, out);
    if (out.means == Means::kSqueeze) out.means = Means::kGrasp;
  }
  return out;
}

using Eigen::Vector3d;

Fingertips::Fingertips(const HandModel& hand, int fingers) {
  ArticulatedBody body(hand);
  const Synergy synergy(hand);
  const auto carries = [&hand](int link) {
    return std::any_of(hand.links.begin(), hand.links.end(),
                       [link](const HandLink& other) { return other.parent == link; });
  };
  for (int i = 0; i < kPostures; ++i) {
    AxisPosition q(hand.axis_count);
    if (fingers >= 0) q[fingers] = kMost_rad * i / (kPostures - 1);
    JointPosition theta;
    synergy.expand(q, theta);
    body.updateKinematics(theta);
    for (int k = 0; k < 6; ++k) {
      const Vector3d along = (k < 3 ? 1.0 : -1.0) * Vector3d::Unit(k % 3);
      double furthest_m = -std::numeric_limits<double>::infinity();
      for (const Capsule& c : hand.capsules) {
        if (c.part == HandPart::kPalm || c.part == HandPart::kThumb || carries(c.link)) continue;
        const Vector3d tip_m = body.linkPose(c.link) * c.b_m + c.radius_m * along;
        if (along.dot(tip_m) <= furthest_m) continue;
        furthest_m = along.dot(tip_m);
        at_[i][k] = tip_m;
      }
    }
  }
}

Vector3d Fingertips::foremost(const Vector3d& toward, double flexion_rad) const noexcept {
  int k = 0;
  toward.cwiseAbs().maxCoeff(&k);
  if (toward[k] < 0.0) k += 3;
  const double place = (kPostures - 1) * std::clamp(flexion_rad / kMost_rad, 0.0, 1.0);
  const int i = std::min(static_cast<int>(place), kPostures - 2);
  return at_[i][k] + (place - i) * (at_[i + 1][k] - at_[i][k]);
}

namespace {

using Eigen::Vector3d;

using namespace approach;

constexpr double kStraight = 0.0;
// At this flexion the fingers point sideways and pass behind a bar in front of a surface.
constexpr double kHooked = 100.0 * kDeg;
constexpr double kBeside_m = 0.09, kAside_m = 0.06, kBefore_m = 0.05, kGently_m = 0.01;
constexpr double kClosing_rad_s = 1.0;
// Speed of the grip while carrying, factor on the required force, least grip force.
constexpr double kCarry_m_s = 0.06, kFirmly = 2.0, kLeastGrip_n = 3.0;
// Largest lead of the intention over the carried thing. The search lead applies while the force on
// the hand is below kFelt_n.
constexpr double kAhead_m = 0.05, kSearch_m = 0.15, kFelt_n = 0.02;
constexpr double kNear_m = 0.01, kBend_rad = 0.2, kPush_m_s = 0.15;
// Low-pass share of each new record in the observed finger flexion.
constexpr double kSeen = 0.01;
// Below this grip force the hand follows a thing that moves away, at this speed.
constexpr double kLoose_n = 0.3, kFollow_m_s = 0.05;
// The player starts the step's approach again after this time without force on the hand.
constexpr double kPatience_s = 2.0;

}  // namespace

KitchenPlayer::KitchenPlayer(const KitchenTask& task, const DeviceModel& device,
                             const HandModel& hand, const PlayerTraits& traits)
    : ClosingPlayer(playerReach(device, &hand, 0.0), traits.opening_rad_s,
                    0.8 + 0.1 * static_cast<double>(traits.seed % 5)),
      task_(task),
      fingertips_(hand, hand_.fingers) {
  start_ = approach::start(hand_);
  // Starts beside the things, so that they are in front of the palm even if the device cannot draw
  // back far.
  if (hand_.y >= 0) {
    start_[hand_.y] =
        std::clamp(-hand_.beside * kAside_m, hand_.lower[hand_.y], hand_.upper[hand_.y]);
  }
  KitchenPlayer::reset();
}

void KitchenPlayer::reset() {
  toStart();
  done_ = false;
  squeeze_n_ = handle_n_ = idle_s_ = joint_q_ = aim_q_ = 0.0;
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

/// Decides how the hand meets the current step's thing.
void KitchenPlayer::meet() noexcept {
  met_ = now().thing;
  meeting_ = meetingOf(task_, step_, joint_q_, bodies_[met_].position_m.eigen(), hand_.beside);
  clear_m_ = meeting_.means == Means::kPush
                 ? Vector3d(-kBefore_m * meeting_.toward)
                 : Vector3d(-hand_.beside * kBeside_m * Vector3d::UnitY());
}

/// Offset of the hand's base from the contact point on a thing [m].
Vector3d KitchenPlayer::baseFrom(const Meeting& meeting, const Thing& thing,
                                 double flexion_rad) const noexcept {
  if (meeting.means == Means::kPush) return -fingertips_.foremost(meeting.toward, flexion_rad);
  return -hand_.grip_m - hand_.beside * thing.radius_m * Vector3d::UnitY();
}

KitchenPlayer::MeetingPose KitchenPlayer::metAt(int step, double q,
                                                const Vector3d& center_m) const noexcept {
  const std::size_t at = std::min<std::size_t>(step, task_.steps.size() - 1);
  const Meeting meeting = meetingOf(task_, step, q, center_m, hand_.beside);
  return {meeting, baseFrom(meeting, task_.things[task_.steps[at].thing], kStraight)};
}

/// The same offset for the current thing. The actual flexion may exceed the intended one.
Vector3d KitchenPlayer::baseFromPoint(double flexion_rad) const noexcept {
  return baseFrom(meeting_, task_.things[met_], flexion_rad);
}

/// Calls pointAt() for an intended q that may be ahead of the thing's q. Beyond kBend_rad on a
/// hinge the path continues along its tangent.
Vector3d KitchenPlayer::pointAhead(double q) const noexcept {
  const Thing& thing = task_.things[met_];
  if (!thing.jointed || !thing.joint.isHinge()) return pointAt(q);
  const double near = std::clamp(q, joint_q_ - kBend_rad, joint_q_ + kBend_rad);
  constexpr double kStep = 1e-3;
  return pointAt(near) + (q - near) / kStep * (pointAt(near + kStep) - pointAt(near));
}

/// Current contact point on the thing [world].
Vector3d KitchenPlayer::pointMet() const noexcept {
  return worldPoint(bodies_[met_], task_.things[met_].grip_m + meeting_.side_m);
}

/// Contact point at joint position q; for a thing without joint, at distance q along its path [m].
Vector3d KitchenPlayer::pointAt(double q) const noexcept {
  const Thing& thing = task_.things[met_];
  if (thing.jointed) {
    return poseOn(thing.joint, thing.start, q) * (thing.grip_m + thing.com_m + meeting_.side_m);
  }
  return free_from_m_ + q * free_way_;
}

Vector3d KitchenPlayer::baseNow() const noexcept {
  Vector3d base_m = Vector3d::Zero();
  const int axes[] = {hand_.x, hand_.y, hand_.z};
  for (int k = 0; k < 3; ++k) {
    if (axes[k] >= 0) base_m[k] = q_[axes[k]];
  }
  return base_m;
}

AxisPosition KitchenPlayer::goalOf(Phase phase) const noexcept {
  Goal goal(hand_, q_);
  const bool pushes = meeting_.means == Means::kPush;
  const double open = pushes ? kStraight : kHooked;
  const double flexion_rad = phase == Phase::kAlign ? kStraight : flexion_rad_;
  const Vector3d at_m = pointMet() + baseFromPoint(flexion_rad), clear_m = at_m + clear_m_;
  switch (phase) {
    case Phase::kDrawBack:
    case Phase::kRest:
      return goal.drawBack();
    case Phase::kAlign:
      return goal.pose({back_m(hand_), clear_m.y(), clear_m.z()}, open, kTurnedAside);
    case Phase::kEnter:
    case Phase::kLeave:
      return goal.pose(clear_m, open, kTurnedAside);
    case Phase::kTouch:
      return goal.pose(pushes ? Vector3d(at_m - kGently_m * meeting_.toward) : at_m, open,
                       pushes ? kTurnedAside : kOpposed);
    case Phase::kOpen:
      return goal.pose(pushes ? clear_m : at_m, open, kTurnedAside);
    case Phase::kClose:
    case Phase::kCarry:
      break;
  }
  return goal.at();
}

void KitchenPlayer::go(Phase phase) noexcept {
  phase_ = phase;
  idle_s_ = 0.0;
  if (phase == Phase::kAlign) meet();
  if (phase == Phase::kCarry) {
    const Vector3d way_m = now().center_m - bodies_[met_].position_m.eigen();
    free_from_m_ = pointMet();
    free_way_ = now().verb == Verb::kPut ? Vector3d(way_m.normalized()) : meeting_.toward;
    aim_q_ = task_.things[met_].jointed ? joint_q_ : 0.0;
    aside_m_ = baseNow() - pointMet();
  }
  moveTo(goalOf(phase), phase == Phase::kTouch);
}

void KitchenPlayer::advance(double period_s, AxisPosition& q, AxisVelocity& qd) noexcept {
  if (takesOver()) go(Phase::kOpen);
  if (isHeld()) {
    idle_s_ = handle_n_ < kFelt_n ? idle_s_ + period_s : 0.0;
    const AxisPosition before = q_;
    if (meeting_.means != Means::kPush) close(period_s);
    if (phase_ == Phase::kCarry) {
      carry(period_s);
    } else if (squeeze_n_ < kLoose_n && meeting_.means == Means::kGrasp) {
      moveBaseTo(pointMet() + baseFromPoint(flexion_rad_),
                 kFollow_m_s * period_s);  // follows a thing that moved away
    }
    for (int a = 0; a < qd_.size(); ++a) qd_[a] = (q_[a] - before[a]) / period_s;
  } else {
    reach_.advance(period_s, q_, qd_);
  }
  q = q_;
  qd = qd_;
}

/// Closing speed as a share of the largest, -1 .. 1. A grasp closes until the grip is firm; a
/// squeeze moves the thing towards its goal.
double KitchenPlayer::closing() const noexcept {
  if (meeting_.means == Means::kSqueeze) return meeting_.sign * speedFactor();
  double asked_n = kLeastGrip_n;
  for (const Step& each : task_.steps) {
    if (each.verb == Verb::kTake) asked_n = std::max(asked_n, kFirmly * each.force_n);
  }
  return (asked_n - squeeze_n_) / asked_n;
}

/// Required rate of q as a share of the largest, with sign, -1 .. 1; 0: no motion.
double KitchenPlayer::speedFactor() const noexcept {
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
  const double wanted_rad_s = std::clamp(kClosing_rad_s * closing(), -0.2, kClosing_rad_s);
  closeBy(wanted_rad_s, kHooked, period_s);
}

// Leads the thing along its joint's path. The intention moves ahead of the thing until the thing
// reaches its goal, because friction and the compliance of the arm hold it back.
void KitchenPlayer::carry(double period_s) noexcept {
  const bool jointed = task_.things[met_].jointed;
  const double way_m =
      jointed ? std::max(1e-3, (pointAt(aim_q_ + 1e-3) - pointAt(aim_q_)).norm() / 1e-3) : 1.0;
  const double rate = pace_ * speedFactor() * kCarry_m_s / way_m;
  const double ahead = (handle_n_ < kFelt_n ? kSearch_m : kAhead_m) / way_m;
  const double from = jointed ? joint_q_ : free_way_.dot(pointMet() - free_from_m_);
  const double next = aim_q_ + rate * period_s;
  if (std::abs(next - from) < std::max(ahead, std::abs(aim_q_ - from))) aim_q_ = next;
  const bool pushes = meeting_.means == Means::kPush;
  const Vector3d base_m = pushes ? baseFromPoint(flexion_rad_) : aside_m_;
  moveBaseTo(pointAhead(aim_q_) + base_m, (pushes ? kPush_m_s : kArm_m_s) * period_s);
}

/// Moves the base towards `base_m` by at most `most_m` along each axis.
void KitchenPlayer::moveBaseTo(const Vector3d& base_m, double most_m) noexcept {
  const int axes[] = {hand_.x, hand_.y, hand_.z};
  for (int k = 0; k < 3; ++k) {
    const int axis = axes[k];
    if (axis < 0) continue;
    const double to = std::clamp(base_m[k], hand_.lower[axis], hand_.upper[axis]);
    const double by = std::clamp(to - q_[axis], -most_m, most_m);
    q_[axis] += by;
  }
}

void KitchenPlayer::onRecord(const TickRecord& record) noexcept {
  steeredByOthers(record);
  const ExerciseRecord& reported = record.exercise;
  if (reported.value_count != kValues) return;  // records have no values during the ramp to neutral
  done_ = reported.values[kDone] > 0.5;
  step_ = static_cast<int>(reported.values[kStep]);
  squeeze_n_ = reported.values[kSqueeze];
  handle_n_ = reported.values[kHandle];
  joint_q_ = reported.values[kJoint];
  if (hand_.fingers >= 0) flexion_rad_ += kSeen * (record.q_s[hand_.fingers] - flexion_rad_);
  for (std::size_t i = 0; i < task_.things.size(); ++i) {
    bodies_[i] = record.bodies[task_.things[i].body];
  }
  if (!lost_) next();
}

/// Enters the next phase if the current one is over.
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
