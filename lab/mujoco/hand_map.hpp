#pragma once

#include "loop/core/real_time.hpp"
#include "loop/dynamics/synergy.hpp"
#include "loop/physics/physics_world.hpp"

#include <array>
#include <mujoco/mujoco.h>
#include <vector>

namespace wholehand::mujoco {

/// Maps between the hand's coordinates q_s and the joints that MuJoCo integrates. Real-time safe
/// except for construction.
class HandMap {
 public:
  /// @pre hand outlives this; model contains it (model_text.hpp)
  HandMap(const HandModel& hand, const mjModel& model);

  /// Errors for axes that drive no joint alone: MuJoCo has armature on joints only.
  [[nodiscard]] Diagnostics refuse() const;

  /// Sets the joints to θ₀ + G q_s with velocities G q̇_s.
  WHOLEHAND_RT void put(mjData& data, const AxisPosition& q_s,
                        const AxisVelocity& qd_s) const noexcept;
  /// Reads the q_s and q̇_s nearest to MuJoCo's joints (least squares). Returns the largest |θ −
  /// (θ₀ + G q_s)|.
  WHOLEHAND_RT double take(const mjData& data, AxisPosition& q_s,
                           AxisVelocity& qd_s) const noexcept;
  /// Applies the torques τ, and the armature A on the joints that one axis drives alone.
  WHOLEHAND_RT void drive(mjModel& model, mjData& data, const HandDrive& drive) const noexcept;

  [[nodiscard]] const HandModel& hand() const noexcept { return *hand_; }
  [[nodiscard]] const Synergy& synergy() const noexcept { return synergy_; }
  /// Index of a joint's velocity coordinate in MuJoCo.
  [[nodiscard]] int dof(int joint) const noexcept { return dof_[joint]; }

 private:
  const HandModel* hand_;
  Synergy synergy_;
  std::array<int, kMaxJoints> position_{};  ///< index of a joint in qpos
  std::array<int, kMaxJoints> dof_{};       ///< index of a joint in qvel
  std::vector<int> alone_;                  ///< per axis: a joint that only this axis drives; -1:
                                            ///< none
  Eigen::MatrixXd back_;                    ///< (GᵀG)⁻¹ Gᵀ
};

}  // namespace wholehand::mujoco
