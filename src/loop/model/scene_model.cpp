#include "loop/model/scene_model.hpp"

#include "loop/core/world_query.hpp"
#include "loop/model/principal_axes.hpp"

#include <Eigen/Geometry>
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>
#include <numbers>
#include <numeric>
#include <utility>

namespace wholehand {

namespace {

using Eigen::AlignedBox3d;
using Eigen::Matrix3d;
using Eigen::Vector3d;
using std::numbers::pi;

constexpr double kTouching_m = 1e-6;  ///< shapes that overlap less deep touch
constexpr int kOverlapCells = 24;     ///< of the grid along each side of the box of an overlap

/// The part of `shape` that lies within earlier shapes, those with a box, at unit density.
MassProperties countedAgain(const Shape& shape, const std::vector<Shape>& shapes,
                            const std::vector<AlignedBox3d>& boxes) {
  const AlignedBox3d own = boxOf(shape);
  AlignedBox3d room;
  std::vector<const Shape*> near;
  for (std::size_t i = 0; i < boxes.size(); ++i) {
    const AlignedBox3d common = own.intersection(boxes[i]);
    if (common.isEmpty() || !(common.volume() > 0.0)) continue;
    room.extend(common);
    near.push_back(&shapes[i]);
  }
  if (near.empty()) return {};
  const Vector3d cell_m = room.sizes() / kOverlapCells;
  double count = 0.0;
  Vector3d first = Vector3d::Zero();
  Matrix3d second = Matrix3d::Zero();
  for (int n = 0; n < kOverlapCells * kOverlapCells * kOverlapCells; ++n) {
    const Eigen::Vector3i cell(n % kOverlapCells, n / kOverlapCells % kOverlapCells,
                               n / (kOverlapCells * kOverlapCells));
    const Vector3d place = cell.cast<double>();
    const Vector3d p = room.min() + cell_m.cwiseProduct(place + Vector3d::Constant(0.5));
    const auto holds = [&](const Shape& s) { return signedDistance(s, p) < -kTouching_m; };
    if (!holds(shape) ||
        std::none_of(near.begin(), near.end(), [&](const Shape* other) { return holds(*other); })) {
      continue;
    }
    const Vector3d from = p - room.min();
    count += 1.0;
    first += from;
    second += from * from.transpose();
  }
  if (count == 0.0) return {};
  const double volume_m3 = cell_m.prod();
  const Vector3d center = first / count;
  // A cell has a second moment of its own, h²/12 along each side h.
  const Matrix3d own_m2 = Matrix3d((cell_m.cwiseAbs2() / 12.0).asDiagonal());
  const Matrix3d central =
      volume_m3 * (second - count * center * center.transpose() + count * own_m2);
  return {count * volume_m3, room.min() + center, central.trace() * Matrix3d::Identity() - central};
}

}  // namespace

int SceneModel::bodyIndex(const std::string& body_name) const {
  for (std::size_t i = 0; i < bodies.size(); ++i) {
    if (bodies[i].name == body_name) return static_cast<int>(i);
  }
  return -1;
}

std::vector<std::string> SceneModel::recordedBodies() const {
  std::vector<std::string> names;
  for (const SceneBody& body : bodies) names.push_back(body.name);
  for (int slot = 0; slot < game.slots; ++slot) names.push_back("slot " + std::to_string(slot));
  names.resize(std::min<std::size_t>(names.size(), kMaxBodies));
  return names;
}

std::vector<int> SceneModel::recordedJoints() const {
  std::vector<int> on_joints;
  for (std::size_t i = 0; i < std::min<std::size_t>(bodies.size(), kMaxBodies); ++i) {
    if (bodies[i].joint) on_joints.push_back(static_cast<int>(i));
  }
  return on_joints;
}

Shape coreOf(const SceneBody& body, const Shape& shape) {
  Shape core = shape;
  if (shape.isCylinder()) core.radius_m -= body.soft_m;
  return core;
}

void mirror(SceneModel& scene) {
  const Matrix3d reflect = Vector3d(1.0, -1.0, 1.0).asDiagonal();
  const auto turned = [&](Pose& pose) {
    pose = {reflect * pose.rotation * reflect, reflect * pose.translation_m};
  };
  scene.gravity_m_s2 = reflect * scene.gravity_m_s2;
  for (SceneBody& body : scene.bodies) {
    turned(body.pose);
    body.com_m = reflect * body.com_m;
    body.inertia_kg_m2 = reflect * body.inertia_kg_m2 * reflect;
    for (Shape& shape : body.shapes) {
      turned(shape.in_body);
      for (Vector3d& point_m : shape.points_m) point_m = reflect * point_m;
      for (Eigen::Vector3i& corners : shape.triangles) std::swap(corners[1], corners[2]);
    }
    if (!body.joint) continue;
    SceneJoint& joint = *body.joint;
    joint.point_m = reflect * joint.point_m;
    // The axis of a hinge is a pseudovector: a reflection also reverses the sense of rotation.
    joint.axis = joint.isHinge() ? Vector3d(-(reflect * joint.axis)) : reflect * joint.axis;
  }
}

std::vector<std::vector<int>> jointChains(const std::vector<SceneBody>& bodies) {
  // The first body of each body's chain: disjoint sets.
  std::vector<int> first(bodies.size());
  std::iota(first.begin(), first.end(), 0);
  const auto root = [&](int body) {
    while (first[body] != body) body = first[body];
    return body;
  };
  for (std::size_t i = 0; i < bodies.size(); ++i) {
    if (!bodies[i].joint) continue;
    for (const int other : {bodies[i].joint->parent, bodies[i].joint->follows}) {
      if (other < 0) continue;
      const int a = root(static_cast<int>(i)), b = root(other);
      first[std::max(a, b)] = std::min(a, b);
    }
  }
  std::vector<std::vector<int>> members(bodies.size());
  for (std::size_t i = 0; i < bodies.size(); ++i) {
    members[root(static_cast<int>(i))].push_back(static_cast<int>(i));
  }
  std::erase_if(members, [](const std::vector<int>& of) { return of.size() < 2; });
  return members;
}

Pose poseOn(const SceneJoint& joint, const Pose& start, double q) noexcept {
  if (!joint.isHinge()) {
    return {start.rotation, start.translation_m + q * (start.rotation * joint.axis)};
  }
  const Eigen::Matrix3d turned =
      start.rotation * Eigen::AngleAxisd(q, joint.axis).toRotationMatrix();
  return {turned, start * joint.point_m - turned * joint.point_m};
}

double positionOn(const SceneJoint& joint, const Pose& start, const Pose& pose,
                  double last) noexcept {
  if (!joint.isHinge()) return positionOn(joint, start, pose);
  constexpr double kTurn = 2.0 * std::numbers::pi;
  SceneJoint endless = joint;
  endless.least = -std::numeric_limits<double>::infinity();
  endless.most = std::numeric_limits<double>::infinity();
  const double q = positionOn(endless, start, pose);
  return std::clamp(q + kTurn * std::round((last - q) / kTurn), joint.least, joint.most);
}

double positionOn(const SceneJoint& joint, const Pose& start, const Pose& pose) noexcept {
  constexpr double kTurn = 2.0 * std::numbers::pi;
  double q = 0.0;
  if (joint.isHinge()) {
    const Eigen::Quaterniond turn(Eigen::Matrix3d(start.rotation.transpose() * pose.rotation));
    q = 2.0 * std::atan2(joint.axis.dot(turn.vec()), turn.w());
    // q and -q of a quaternion are the same rotation, and so are q and q ± 2π of the joint: chooses
    // the one within the range.
    q -= kTurn * std::round(q / kTurn);
    if (q > joint.most && q - kTurn >= joint.least) q -= kTurn;
    if (q < joint.least && q + kTurn <= joint.most) q += kTurn;
  } else {
    q = (start.rotation * joint.axis).dot(pose.translation_m - start.translation_m);
  }
  return std::clamp(q, joint.least, joint.most);
}

ShapeMoments moments(const std::vector<Shape>& shapes) {
  MassProperties sum;  // at unit density: numbers in kg are in m³ here
  std::vector<AlignedBox3d> boxes;
  for (const Shape& shape : shapes) {
    const ShapeMoments m = moments(shape);
    sum = combined(sum, {m.volume_m3, m.center_m, m.inertia_m5});
    const MassProperties again = countedAgain(shape, shapes, boxes);
    if (again.mass_kg > 0.0) {
      sum = combined(sum, {-again.mass_kg, again.com_m, -again.inertia_kg_m2});
    }
    boxes.push_back(boxOf(shape));
  }
  return {sum.mass_kg, sum.com_m, sum.inertia_kg_m2};
}

MassProperties uniformDensity(const std::vector<Shape>& shapes, double mass_kg) {
  const ShapeMoments unit = moments(shapes);
  if (!(unit.volume_m3 > 0.0)) return {};
  return {mass_kg, unit.center_m, mass_kg / unit.volume_m3 * unit.inertia_m5};
}

MassProperties combined(const MassProperties& a, const MassProperties& b) {
  const double mass_kg = a.mass_kg + b.mass_kg;
  if (!(mass_kg > 0.0)) return {};
  MassProperties sum;
  sum.mass_kg = mass_kg;
  sum.com_m = (a.mass_kg * a.com_m + b.mass_kg * b.com_m) / mass_kg;
  // Two point masses about their common centre equal one reduced mass at their distance.
  const Eigen::Vector3d between = b.com_m - a.com_m;
  const double reduced_kg = a.mass_kg * b.mass_kg / mass_kg;
  const Eigen::Matrix3d points =
      between.squaredNorm() * Eigen::Matrix3d::Identity() - between * between.transpose();
  sum.inertia_kg_m2 = a.inertia_kg_m2 + b.inertia_kg_m2 + reduced_kg * points;
  return sum;
}

MassProperties moved(const MassProperties& m, const Pose& inner_in_outer) {
  const Eigen::Matrix3d& r = inner_in_outer.rotation;
  return {m.mass_kg, inner_in_outer * m.com_m, r * m.inertia_kg_m2 * r.transpose()};
}

std::string inertiaFault(const Eigen::Matrix3d& inertia_kg_m2) {
  const Eigen::Vector3d principal = principalAxesOf(inertia_kg_m2).moments;
  const std::string moments = fmt::format("(principal moments {:.4g}, {:.4g}, {:.4g} kg·m²)",
                                          principal[0], principal[1], principal[2]);
  if (!(principal[0] > 0.0)) return "is not positive definite " + moments;
  // A flat plate meets the bound exactly: tolerates rounding.
  if (principal[2] > (principal[0] + principal[1]) * (1.0 + 1e-6)) {
    return "breaks the triangle inequality " + moments;
  }
  return {};
}

}  // namespace wholehand
