#pragma once

#include "files/scene/separation.hpp"
#include "files/shipped_models.hpp"
#include "loop/dynamics/articulated_body.hpp"
#include "loop/dynamics/synergy.hpp"
#include "loop/model/device_model.hpp"
#include "loop/physics/axis_closure.hpp"
#include "support/ball_shape.hpp"
#include "support/capsule_shape.hpp"
#include "support/constants.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <vector>

/// The shipped hand and one body, for tests of their first touch.
namespace wholehand::test {

inline const HandModel& hand() {
  static const HandModel hand = handNamed();
  return hand;
}
inline constexpr int kFingers = 3, kCircumduction = 4, kThumb = 5;

inline SceneModel sceneOf(const Shape& shape) {
  SceneModel scene;
  SceneBody& body = scene.bodies.emplace_back();
  body.name = "body";
  body.fixed = true;
  body.com_m = {0.003, -0.002, 0.001};
  body.shapes.push_back(shape);
  return scene;
}

inline BodyState stateOf(const SceneBody& body, const Pose& pose) {
  BodyState state;
  state.position_m = Vec3::from(pose * body.com_m);
  state.orientation_xyzw = QuatXyzw::from(Eigen::Quaterniond(pose.rotation));
  return state;
}

/// True for the parts of the hand that an axis counts as moving. Webs are skin between the fingers
/// and do not count.
inline bool movedBy(int axis, const Capsule& capsule) {
  const HandPart part = capsule.part;
  if (axis == kFingers && capsule.name.starts_with("web")) return true;
  if (axis == kFingers) return part != HandPart::kPalm && part != HandPart::kThumb;
  return part == HandPart::kThumb;
}

/// A hand at rest and a body.
struct Still {
  HandModel model = hand();
  SceneModel scene;
  Pose body_pose;
  AxisPosition q{6};
  AxisClosure closure{model, scene};
  ArticulatedBody body{model};
  Synergy synergy{model};

  explicit Still(SceneModel scene_in) : scene(std::move(scene_in)), closure(model, scene) {}

  AxisPosition tick(int target = 0) {
    JointPosition theta;
    synergy.expand(q, theta);
    body.updateKinematics(theta);
    const BodyState state = stateOf(scene.bodies[0], body_pose);
    AxisPosition touch;
    closure.update(&body.linkPose(0), theta, q, target, &state, touch);
    return touch;
  }

  /// Smallest separation between the body and the parts that `axis` moves, with the axis at
  /// `value`.
  double separationAt(int axis, double value) {
    AxisPosition there = q;
    there[axis] = value;
    JointPosition theta;
    synergy.expand(there, theta);
    body.updateKinematics(theta);
    double least_m = kInfinity;
    for (const Capsule& c : model.capsules) {
      // The metacarpal of the thumb may belong to the palm: only capsules that the axis really
      // moves count.
      if (!moves_[axis].empty() && !moves_[axis][&c - model.capsules.data()]) continue;
      const Shape form = capsuleShape(c.a_m, c.b_m, c.radius_m);
      for (const Shape& shape : scene.bodies[0].shapes) {
        least_m = std::min(least_m, separation(form, body.linkPose(c.link), shape, body_pose));
      }
    }
    return least_m;
  }

  /// Finds the capsules that each axis moves, by moving it.
  void findMoved() {
    for (int axis = kFingers; axis <= kThumb; ++axis) {
      std::vector<bool> moved;
      JointPosition open, closed;
      AxisPosition one(6), other(6);
      other[axis] = 0.5;
      synergy.expand(one, open);
      synergy.expand(other, closed);
      ArticulatedBody a(model), b(model);
      a.updateKinematics(open);
      b.updateKinematics(closed);
      for (const Capsule& c : model.capsules) {
        moved.push_back((a.linkPose(c.link) * c.b_m - b.linkPose(c.link) * c.b_m).norm() > 1e-6);
        EXPECT_TRUE(!moved.back() || movedBy(axis, c)) << c.name;
      }
      moves_[axis] = moved;
    }
  }
  std::array<std::vector<bool>, 6> moves_;
};

inline Shape cylinder(double radius_m, double length_m) {
  Shape s;
  s.type = ShapeType::kCylinder;
  s.radius_m = radius_m;
  s.length_m = length_m;
  return s;
}

}  // namespace wholehand::test
