#include "exercise/kitchen/meeting.hpp"

#include <algorithm>
#include <cmath>

namespace wholehand::kitchen {
namespace {

using Eigen::Vector3d;

bool movesThing(Verb verb) noexcept {
  return verb == Verb::kMove || verb == Verb::kHold || verb == Verb::kPress || verb == Verb::kPut;
}

/// Sign of the change of q that a step wants; a press goes where there is way.
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

/// Takes the direction in which the point met is to move.
void decide(const Vector3d& direction, double beside, Meeting& out) noexcept {
  out.toward = nearestAxis(direction);
  if (out.toward.x() < -0.5) {
    out.means = Means::kGrasp;  // only a closed hand pulls
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
  if (lateral.norm() < 0.5) return;  // a knob that looks at the person is grasped
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

}  // namespace wholehand::kitchen
