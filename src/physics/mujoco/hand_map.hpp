#pragma once

#include "core/real_time.hpp"
#include "dynamics/synergy.hpp"
#include "physics/physics_world.hpp"

#include <array>
#include <mujoco/mujoco.h>
#include <vector>

namespace wholehand::mujoco {

/// Between the hand's few coordinates q_s and the joints that MuJoCo integrates. Real-time safe
/// but for construction.
class HandMap {
 public:
  /// @pre hand outlives this; model holds it (model_text.hpp)
  HandMap(const HandModel& hand, const mjModel& model);

  /// Axes that no joint follows alone: MuJoCo knows armature on joints only.
  [[nodiscard]] Diagnostics refuse() const;

  /// Joints at θ₀ + G q_s, moving at G q̇_s.
  WHOLEHAND_RT void put(mjData& data, const AxisPosition& q_s,
                        const AxisVelocity& qd_s) const noexcept;
  /// The q_s and q̇_s whose joints are nearest to MuJoCo's. Gives the largest |θ − (θ₀ + G q_s)|.
  WHOLEHAND_RT double take(const mjData& data, AxisPosition& q_s,
                           AxisVelocity& qd_s) const noexcept;
  /// τ, and A on the joints that follow their axis alone.
  WHOLEHAND_RT void drive(mjModel& model, mjData& data, const HandDrive& drive) const noexcept;

  [[nodiscard]] const HandModel& hand() const noexcept { return *hand_; }
  [[nodiscard]] const Synergy& synergy() const noexcept { return synergy_; }
  /// MuJoCo's velocity coordinate of a joint of the hand.
  [[nodiscard]] int dof(int joint) const noexcept { return dof_[static_cast<std::size_t>(joint)]; }

 private:
  const HandModel* hand_;
  Synergy synergy_;
  std::array<int, kMaxJoints> position_{};  ///< of a joint in qpos
  std::array<int, kMaxJoints> dof_{};       ///< of a joint in qvel
  std::vector<int> alone_;                  ///< a joint that only this axis drives; -1: none
  Eigen::MatrixXd back_;                    ///< (GᵀG)⁻¹ Gᵀ
};

}  // namespace wholehand::mujoco
