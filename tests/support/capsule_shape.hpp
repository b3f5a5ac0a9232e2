#pragma once

#include "loop/model/scene_model.hpp"

#include <Eigen/Geometry>

namespace wholehand::test {

/// A capsule between two points as a shape, e.g. one of the hand's: ends and radius [m], in the
/// frame that the pose given beside it to separation() places.
inline Shape capsuleShape(const Eigen::Vector3d& a_m, const Eigen::Vector3d& b_m, double radius_m) {
  Shape s;
  s.type = ShapeType::kCapsule;
  s.radius_m = radius_m;
  s.length_m = (b_m - a_m).norm();
  s.in_body.translation_m = (a_m + b_m) / 2.0;
  // Eigen's rotation also serves where the segment has no length or points down.
  s.in_body.rotation = Eigen::Quaterniond::FromTwoVectors(
                           Eigen::Vector3d::UnitZ(),
                           s.length_m > 0.0 ? Eigen::Vector3d(b_m - a_m) : Eigen::Vector3d::UnitZ())
                           .toRotationMatrix();
  return s;
}

}  // namespace wholehand::test
