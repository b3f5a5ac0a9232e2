#pragma once

#include "physics/mujoco/hand_map.hpp"
#include "physics/mujoco/solver_settings.hpp"

#include <vector>

namespace wholehand::mujoco {

/// Makes MuJoCo's constraints act in the hand's reduced velocities. Its rows j act on joints. With
/// P = G M_r⁻¹ GᵀM, the projection on to the synergy, a row becomes j P: its force accelerates the
/// joints by M⁻¹ Pᵀ jᵀ f = G M_r⁻¹ Gᵀ jᵀ f, which keeps the synergy, and does the virtual work of
/// Gᵀ jᵀ f. MuJoCo's solver is used as it is. Real-time safe but for construction.
class ReducedConstraints {
 public:
  /// @pre map outlives this
  ReducedConstraints(const HandMap& map, const mjModel& model, const SolverSettings& settings);

  /// After mj_makeConstraint(): projects all rows, and weighs each contact and joint end by the
  /// mass that it meets. False where the reduced inertia has no inverse.
  [[nodiscard]] WHOLEHAND_RT bool project(const mjModel& model, mjData& data) noexcept;

  /// After mj_fwdVelocity(): what each row wants. What is apart may close its gap in this step and
  /// not pass it; what overlaps is pushed out gently; surfaces that touch do not slide.
  /// @param surface_velocity of the contact's surfaces where no coordinate says it: of geom 2 less
  /// of geom 1, 3 numbers a contact [m/s]
  WHOLEHAND_RT void aim(mjData& data, const double* surface_velocity, double period_s) noexcept;

  /// What the joint ends gave to every axis in the last step [N or N·m].
  [[nodiscard]] WHOLEHAND_RT AxisEffort endEffort(const mjData& data) const noexcept;

 private:
  [[nodiscard]] WHOLEHAND_RT bool reduceInertia(const mjModel& model, mjData& data) noexcept;
  WHOLEHAND_RT void projectRow(double* row) const noexcept;
  WHOLEHAND_RT void weigh(const mjModel& model, mjData& data, int row, int rows) noexcept;
  [[nodiscard]] double goal(double apart, double period_s) const noexcept;

  const HandMap* map_;
  SolverSettings settings_;
  int dofs_;
  std::vector<double> column_, momentum_, half_;  ///< of dofs_ numbers each; momentum_ an axis
  AxisMatrix inverse_;                            ///< M_r⁻¹
  JointAxisMatrix projected_;                     ///< M G M_r⁻¹
};

}  // namespace wholehand::mujoco
