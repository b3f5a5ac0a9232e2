#include "assembly/rehearsal_moves.hpp"

#include "dynamics/articulated_body.hpp"
#include "dynamics/synergy.hpp"
#include "patient/reach.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <string>

namespace wholehand {
namespace {

constexpr double kSpeedShare = 0.7;      // share of each axis's limit, at peak speed
constexpr double kPush_m = 0.04;         // beyond the first touch
constexpr double kWithinReach_m = 0.06;  // distance from the hand's nearest pose
constexpr double kGraspable_m = 0.12;    // wider bodies are pressed at their nearest point
constexpr double kBackAway_m = 0.05;     // start of the back of the fingers, from the body's middle
constexpr std::array kFurther_m{0.0, 0.02, 0.04, 0.06, 0.08};
constexpr std::array kLift_m{0.0, 0.03, 0.06, 0.09};

Eigen::Vector3d middle(const Capsule& capsule, const ArticulatedBody& hand) {
  return hand.linkPose(capsule.link) * (0.5 * (capsule.a_m + capsule.b_m));
}

// Bounding box of a body about its own axes.
struct Box {
  Eigen::Vector3d lower = Eigen::Vector3d::Constant(std::numeric_limits<double>::infinity());
  Eigen::Vector3d upper = -lower;
  void take(const Eigen::Vector3d& p) {
    lower = lower.cwiseMin(p);
    upper = upper.cwiseMax(p);
  }
};

Box boxOf(const SceneBody& body) {
  Box box;
  for (const Shape& shape : body.shapes) {
    Eigen::Vector3d half = shape.half_extents_m;
    if (shape.type == ShapeType::kConvexMesh) {
      for (const Eigen::Vector3d& p : shape.points_m) box.take(shape.in_body * p);
      continue;
    }
    if (shape.type != ShapeType::kBox) {
      const double ends_m = shape.type == ShapeType::kSphere ? shape.radius_m
                            : shape.type == ShapeType::kCapsule
                                ? 0.5 * shape.length_m + shape.radius_m
                                : 0.5 * shape.length_m;
      half = {shape.radius_m, shape.radius_m, ends_m};
    }
    const Eigen::Vector3d reach = shape.in_body.rotation.cwiseAbs() * half;
    box.take(shape.in_body.translation_m - reach);
    box.take(shape.in_body.translation_m + reach);
  }
  return box;
}

// Point of a body to touch: the middle of a graspable dimension, the nearest point otherwise.
Eigen::Vector3d target(const Box& box, const Eigen::Vector3d& from_m) {
  Eigen::Vector3d at = 0.5 * (box.lower + box.upper);
  for (int i = 0; i < 3; ++i) {
    if (box.upper[i] - box.lower[i] > kGraspable_m) {
      at[i] = std::clamp(from_m[i], box.lower[i] + 0.25 * kGraspable_m,
                         box.upper[i] - 0.25 * kGraspable_m);
    }
  }
  return at;
}

Pose poseNow(const SceneBody& body, int index, const TickRecord* observed) {
  if (observed == nullptr || index >= observed->body_count) return body.pose;
  const BodyState& state = observed->bodies[index];
  Pose pose;
  pose.rotation = state.orientation_xyzw.eigen().toRotationMatrix();
  pose.translation_m = state.position_m.eigen() - pose.rotation * body.com_m;
  return pose;
}

double distance(const SceneBody& body, const Eigen::Vector3d& point_m) {
  double nearest_m = std::numeric_limits<double>::infinity();
  for (const Shape& shape : body.shapes) {
    nearest_m = std::min(nearest_m, signedDistance(shape, point_m));
  }
  return nearest_m;
}

}  // namespace

RehearsalPlan::RehearsalPlan(const HandModel& hand, const DeviceModel& device,
                             const SceneModel& scene, const AxisPosition& start)
    : device_(device), scene_(scene), start_(start) {
  ArticulatedBody body(hand);
  const Synergy synergy(hand);
  const auto at = [&](double closed) {
    AxisPosition q = posture(closed);
    q = moved(q, -moveBy(q));
    JointPosition theta;
    synergy.expand(q, theta);
    body.updateKinematics(theta);
  };
  const auto mean_of = [&](auto&& belongs) {
    Eigen::Vector3d sum = Eigen::Vector3d::Zero();
    int count = 0;
    for (const Capsule& c : hand.capsules) {
      if (!belongs(c)) continue;
      sum += middle(c, body);
      ++count;
    }
    return Eigen::Vector3d(count > 0 ? Eigen::Vector3d(sum / count) : sum);
  };
  at(0.5);
  // Palm, fingers and thumb surround it.
  pocket_m_ = (mean_of([](const Capsule& c) { return c.part == HandPart::kPalm; }) +
               mean_of([](const Capsule& c) { return c.part == HandPart::kThumb; }) +
               2.0 * mean_of([](const Capsule& c) {
                 return c.part != HandPart::kPalm && c.part != HandPart::kThumb;
               })) /
              4.0;
  at(0.0);
  palmar_ = -body.linkPose(hand.palm_link).rotation.col(2);
  back_m_ = mean_of(
      [](const Capsule& c) { return c.part != HandPart::kPalm && c.part != HandPart::kThumb; });
}

AxisPosition RehearsalPlan::posture(double closed) const {
  AxisPosition q = start_;
  for (int i = 0; i < q.size(); ++i) {
    const DeviceAxis& axis = device_.axes[i];
    if (axis.group == AxisGroup::kHand) q[i] = axis.lower + closed * (axis.upper - axis.lower);
  }
  return q;
}

Eigen::Vector3d RehearsalPlan::moveBy(const AxisPosition& q) const {
  Eigen::Vector3d at = Eigen::Vector3d::Zero();
  for (int i = 0; i < 3; ++i) {
    const int axis = device_.axisIndex(std::string(1, "xyz"[i]));
    if (axis >= 0) at[i] = q[axis];
  }
  return at;
}

// The pose moved by `by_m`, clamped to the device's range.
AxisPosition RehearsalPlan::moved(const AxisPosition& q, const Eigen::Vector3d& by_m) const {
  AxisPosition out = q;
  for (int i = 0; i < 3; ++i) {
    const int index = device_.axisIndex(std::string(1, "xyz"[i]));
    if (index < 0) continue;
    const DeviceAxis& axis = device_.axes[index];
    out[index] = std::clamp(q[index] + by_m[i], axis.lower, axis.upper);
  }
  return out;
}

RehearsalMove RehearsalPlan::move(int body, const Eigen::Vector3d& target_m,
                                  const Eigen::Vector3d& point_m, const Eigen::Vector3d& push,
                                  double closed) const {
  const AxisPosition open = posture(0.0);
  const Eigen::Vector3d there = target_m - point_m - moveBy(open);
  RehearsalMove move;
  move.body = body;
  for (const double lift_m : kLift_m) {  // bodies on a table are reached from above
    for (const double further_m : kFurther_m) {
      const Eigen::Vector3d by_m = there - further_m * push + lift_m * Eigen::Vector3d::UnitZ();
      move.starts.push_back(moved(open, by_m));
    }
  }
  move.goal = moved(posture(closed), there + kPush_m * push);
  return move;
}

std::vector<RehearsalMove> RehearsalPlan::movesFor(int index, const TickRecord* observed) const {
  const SceneBody& body = scene_.bodies[index];
  const Pose pose = poseNow(body, index, observed);
  const Box box = boxOf(body);
  std::vector<RehearsalMove> moves;
  const auto add = [&](const Eigen::Vector3d& point_m, double away_m, const Eigen::Vector3d& push,
                       double closed) {
    const Eigen::Vector3d home = point_m + moveBy(start_);
    const Eigen::Vector3d at = pose * target(box, pose.inverse() * home);
    const RehearsalMove found = move(index, at - away_m * push, point_m, push, closed);
    const Eigen::Vector3d reached = point_m + moveBy(found.goal);
    if (distance(body, pose.inverse() * reached) < kWithinReach_m) moves.push_back(found);
  };
  add(pocket_m_, 0.0, palmar_, 1.0);
  add(back_m_, kBackAway_m, -palmar_, 0.0);
  return moves;
}

PatientConfig strongPerson(const DeviceModel& device) {
  PatientConfig person;
  person.name = "rehearsal";
  for (const DeviceAxis& axis : device.axes) {
    PatientAxis out;
    out.name = axis.name;
    out.mass = axis.mass;
    out.stiffness = axis.effort_limit / (0.1 * (axis.upper - axis.lower));
    out.damping = 2.0 * std::sqrt(out.stiffness * (axis.mass + out.mass));
    person.axes.push_back(out);
  }
  return person;
}

void Rehearser::begin(const AxisPosition& from, const AxisPosition& goal) {
  from_ = from;
  goal_ = goal;
  reset();
}

void Rehearser::reset() {
  q_ = from_;
  qd_ = AxisVelocity(from_.size());
  pressing_ = false;
  AxisPosition posture = from_;
  for (int i = 0; i < posture.size(); ++i) {
    if (device_.axes[i].group == AxisGroup::kHand) posture[i] = goal_[i];
  }
  reachFor(posture);
}

void Rehearser::press() noexcept {
  pressing_ = true;
  reachFor(goal_);
}

void Rehearser::moveTo(const AxisPosition& goal) noexcept {
  pressing_ = true;
  reachFor(goal);
}

void Rehearser::reachFor(const AxisPosition& goal) noexcept {
  std::array<double, kMaxAxes> needs_s{};
  double longest_s = 1e-3;
  for (int i = 0; i < goal.size(); ++i) {
    const double speed = kSpeedShare * device_.axes[i].speed_limit;
    const double need_s = kMinimumJerkPeak * std::abs(goal[i] - q_[i]) / speed;
    needs_s[i] = need_s;
    longest_s = std::max(longest_s, need_s);
  }
  reach_.begin(q_, qd_, goal, longest_s);
  for (int i = 0; i < goal.size(); ++i) {
    const double share = needs_s[i] / longest_s;
    reach_.during(i, 0.0, std::clamp(share, 1e-3, 1.0));
  }
}

void Rehearser::advance(double period_s, AxisPosition& q, AxisVelocity& qd) noexcept {
  reach_.advance(period_s, q, qd);
  q_ = q;
  qd_ = qd;
}

}  // namespace wholehand
