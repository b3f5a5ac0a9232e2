#pragma once

#include "lab/mujoco/hand_map.hpp"
#include "lab/mujoco/solver_settings.hpp"

#include <vector>

namespace wholehand::mujoco {

/// Makes MuJoCo's constraints act in the hand's reduced velocities. MuJoCo's constraint rows j act
/// on joints. With the projection onto the synergy, P = G M_r⁻¹ GᵀM, a row becomes j P. Its force
/// accelerates the joints by M⁻¹ Pᵀ jᵀ f = G M_r⁻¹ Gᵀ jᵀ f, which preserves the synergy, and does
/// the virtual work of Gᵀ jᵀ f. MuJoCo's solver is unchanged. Real-time safe except for
/// construction.
class ReducedConstraints {
 public:
  /// @pre map outlives this
  ReducedConstraints(const HandMap& map, const mjModel& model, const SolverSettings& settings);

  /// Call after mj_makeConstraint(): projects all rows and scales each contact and joint limit by
  /// its effective mass. Returns false when the reduced inertia is singular.
  [[nodiscard]] WHOLEHAND_RT bool project(const mjModel& model, mjData& data) noexcept;

  /// Call after mj_fwdVelocity(): sets each row's target. Separated surfaces may close their gap in
  /// this step but not penetrate. Overlapping surfaces are pushed apart gently. Touching surfaces
  /// do not slide.
  /// @param surface_velocity velocity of the contact's surfaces that no coordinate represents: geom
  /// 2 minus geom 1, 3 numbers per contact [m/s]
  WHOLEHAND_RT void aim(mjData& data, const double* surface_velocity, double period_s) noexcept;

  /// Effort of the joint limits on every axis in the last step [N or N·m].
  [[nodiscard]] WHOLEHAND_RT AxisEffort endEffort(const mjData& data) const noexcept;

 private:
  [[nodiscard]] WHOLEHAND_RT bool reduceInertia(const mjModel& model, mjData& data) noexcept;
  WHOLEHAND_RT void projectRow(double* row) const noexcept;
  WHOLEHAND_RT void weigh(const mjModel& model, mjData& data, int row, int rows) noexcept;
  [[nodiscard]] double goal(double apart, double period_s) const noexcept;

  const HandMap* map_;
  SolverSettings settings_;
  int dofs_;
  std::vector<double> column_, momentum_, half_;  ///< dofs_ numbers each; momentum_ per axis
  AxisMatrix inverse_;                            ///< M_r⁻¹
  JointAxisMatrix projected_;                     ///< M G M_r⁻¹
};

}  // namespace wholehand::mujoco
