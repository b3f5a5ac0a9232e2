#pragma once

#include "core/geometry.hpp"
#include "model/hand_model.hpp"

#include <Eigen/Core>

namespace wholehand {

/// A rolled cuff and a sleeve that hide where the hand ends. Their size follows the palm's
/// capsules; they are drawn, never felt.
class Sleeve {
 public:
  /// @param palm world pose of the palm link
  Sleeve(const HandModel& hand, const Pose& palm);

  [[nodiscard]] bool empty() const noexcept { return empty_; }
  /// Signed distances in the world frame [m].
  [[nodiscard]] double cuff(const Eigen::Vector3d& p_m) const noexcept;
  [[nodiscard]] double cloth(const Eigen::Vector3d& p_m) const noexcept;
  /// 0 at the cuff, 1 where the forearm has dissolved into the backdrop.
  [[nodiscard]] double dissolved(const Eigen::Vector3d& p_m) const noexcept;

  [[nodiscard]] Eigen::Vector3d center() const { return palm_ * middle_m_; }
  [[nodiscard]] double radius() const noexcept { return radius_m_; }

 private:
  [[nodiscard]] Eigen::Vector3d straightened(const Eigen::Vector3d& p_m) const noexcept;

  Pose palm_, to_palm_;
  bool empty_ = true;
  double ulnar_ = -1.0;           // sign of the little finger's side along y
  double rim_m_ = 0.0;            // distal edge of the cuff along x
  Eigen::Vector2d axis_m_{0, 0};  // centre of the wrist's section in y, z
  Eigen::Vector2d half_m_{0, 0};  // half axes of the cuff's inner ellipse
  Eigen::Vector3d middle_m_ = Eigen::Vector3d::Zero();
  double radius_m_ = 0.0;
};

}  // namespace wholehand
