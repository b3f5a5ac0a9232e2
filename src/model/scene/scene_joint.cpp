#include "model/scene/scene_joint.hpp"

#include <Eigen/Geometry>

#include <algorithm>
#include <cmath>
#include <numbers>

namespace wholehand {

Pose poseOn(const SceneJoint& joint, const Pose& start, double q) noexcept {
  if (!joint.isHinge()) {
    return {start.rotation, start.translation_m + q * (start.rotation * joint.axis)};
  }
  const Eigen::Matrix3d turned =
      start.rotation * Eigen::AngleAxisd(q, joint.axis).toRotationMatrix();
  return {turned, start * joint.point_m - turned * joint.point_m};
}

double positionOn(const SceneJoint& joint, const Pose& start, const Pose& pose) noexcept {
  constexpr double kTurn = 2.0 * std::numbers::pi;
  double q = 0.0;
  if (joint.isHinge()) {
    const Eigen::Quaterniond turn(Eigen::Matrix3d(start.rotation.transpose() * pose.rotation));
    q = 2.0 * std::atan2(joint.axis.dot(turn.vec()), turn.w());
    // Both signs of a quaternion are one turn, as are q and q ± 2π of a range that is not about 0.
    q -= kTurn * std::round(q / kTurn);
    if (q > joint.most && q - kTurn >= joint.least) q -= kTurn;
    if (q < joint.least && q + kTurn <= joint.most) q += kTurn;
  } else {
    q = (start.rotation * joint.axis).dot(pose.translation_m - start.translation_m);
  }
  return std::clamp(q, joint.least, joint.most);
}

}  // namespace wholehand
