#pragma once

#include <Eigen/Core>

#include <array>

#include "core/axis_array.hpp"
#include "core/real_time.hpp"
#include "model/hand_model.hpp"

namespace wholehand {

/// The most links a hand may have, locked joints included.
inline constexpr int kMaxLinks = 40;

/// Joint-space dynamics of the hand, and the same reduced by the synergy map G.
///
///   M(θ) θ̈ + h(θ, θ̇) = τ          (paper Eq. 1)
///   M_r = Gᵀ M G,  h_r = Gᵀ h       (G constant)
///
/// h by the recursive Newton-Euler algorithm, M by the composite-rigid-body algorithm, both in world
/// axes about the world origin. Storage is fixed; nothing allocates after construction.
class ArticulatedBody {
 public:
  /// @pre hand outlives this; links <= kMaxLinks
  explicit ArticulatedBody(const HandModel& hand);

  /// Link frames only: pose of every link, joint axes and origins in the world. Real-time safe.
  WHOLEHAND_RT void updateKinematics(const JointPosition& theta) noexcept;

  /// Kinematics, h, M, M_r, h_r and M_r⁻¹ (Cholesky). Returns false when M_r is not positive
  /// definite (the inverse is then zero). Real-time safe.
  [[nodiscard]] WHOLEHAND_RT bool update(const JointPosition& theta,
                                         const JointVelocity& theta_dot,
                                         const Eigen::Vector3d& gravity_m_s2) noexcept;

  /// τ = M G a + h with a = M_r⁻¹ f_s: the joint torques whose reduced force is exactly f_s + h_r and
  /// under which the synergy θ = θ₀ + G q_s keeps itself. Real-time safe.
  WHOLEHAND_RT void distribute(const AxisEffort& f_s, JointEffort& torque) const noexcept;

  /// Row of the reduced Jacobian: velocity per axis of the link's material point at `point_m` (world)
  /// along `direction` (world), j = Gᵀ Jᵀ direction. Real-time safe.
  WHOLEHAND_RT void reducedPointRow(int link, const Eigen::Vector3d& point_m,
                                    const Eigen::Vector3d& direction,
                                    double* row /* axis_count */) const noexcept;
  /// The same for the link's angular velocity about `direction`.
  WHOLEHAND_RT void reducedAngularRow(int link, const Eigen::Vector3d& direction,
                                      double* row /* axis_count */) const noexcept;

  [[nodiscard]] const JointEffort& bias() const noexcept { return bias_; }              ///< h
  [[nodiscard]] const JointMatrix& inertia() const noexcept { return inertia_; }        ///< M
  [[nodiscard]] const AxisEffort& reducedBias() const noexcept { return reduced_bias_; }  ///< h_r
  [[nodiscard]] const AxisMatrix& reducedInertia() const noexcept { return reduced_inertia_; }
  [[nodiscard]] const AxisMatrix& reducedInertiaInverse() const noexcept {
    return reduced_inertia_inverse_;
  }
  [[nodiscard]] const Pose& linkPose(int link) const noexcept { return pose_[link]; }
  [[nodiscard]] const HandModel& hand() const noexcept { return *hand_; }

 private:
  const HandModel* hand_;
  std::array<Pose, kMaxLinks> pose_;
  JointEffort bias_;
  JointMatrix inertia_;
  AxisEffort reduced_bias_;
  AxisMatrix reduced_inertia_;
  AxisMatrix reduced_inertia_inverse_;
};

}  // namespace wholehand
