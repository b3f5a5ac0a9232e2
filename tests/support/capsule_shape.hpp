#pragma once

#include "loop/model/scene_model.hpp"

#include <Eigen/Geometry>

namespace wholehand::test {

/// A capsule between two points as a shape, e.g. one of the hand's. Ends and radius [m] are in the
/// frame of the pose that separation() takes with it.
inline Shape capsuleShape(const Eigen::Vector3d& a_m, const Eigen::Vector3d& b_m, double radius_m) {
  Shape s;
  s.type = ShapeType::kCapsule;
  s.radius_m = radius_m;
  s.length_m = (b_m - a_m).norm();
  s.in_body.translation_m = (a_m + b_m) / 2.0;
  // Eigen's rotation also works for a segment without length or one that points down.
  s.in_body.rotation = Eigen::Quaterniond::FromTwoVectors(
                           Eigen::Vector3d::UnitZ(),
                           s.length_m > 0.0 ? Eigen::Vector3d(b_m - a_m) : Eigen::Vector3d::UnitZ())
                           .toRotationMatrix();
  return s;
}

}  // namespace wholehand::test
