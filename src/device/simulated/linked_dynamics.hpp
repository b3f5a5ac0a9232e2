#pragma once

#include "core/axis_array.hpp"
#include "core/real_time.hpp"
#include "device/simulated/box_problem.hpp"

namespace wholehand {

/// Mechanical model of axes linked by a person. SI, each axis in its own unit.
struct LinkedPlant {
  AxisMatrix mass;            ///< device and person; symmetric positive definite
  AxisMatrix damping;         ///< of both, viscous; symmetric positive semidefinite
  AxisMatrix stiffness;       ///< of the person, to position 0; positive semidefinite
  AxisEffort coulomb;         ///< dry friction of each axis, >= 0
  AxisPosition lower, upper;  ///< stops
};

/// Axes linked by a person: M q̈ + B q̇ + K q + f_c sign(q̇) = f(t), each between two inelastic
/// stops.
///
/// The linear part is advanced by its exact solution for an effort that is linear over the period,
/// in steps of at most 1/16 ms or 1/16 rad of the fastest mode. Over a step, dry friction and stops
/// are constant efforts λ that bring the axis to rest by its end as far as they can. Friction is at
/// most f_c and never along the motion, so it only dissipates. The instant at which an axis starts
/// or stops is resolved to one step. Impact on a stop removes the speed towards it by an impulse,
/// which the mass matrix distributes over the axes; it only dissipates, too.
class LinkedDynamics {
 public:
  /// @pre one size, as LinkedPlant says  Not real-time safe.
  LinkedDynamics(const LinkedPlant& plant, double period_s);

  /// Advances by one period; efforts at its beginning and end, linear between. Real-time safe.
  WHOLEHAND_RT void advance(const AxisEffort& begin, const AxisEffort& end) noexcept;

  /// Sets the state, clamped to the stops. Real-time safe.
  WHOLEHAND_RT void place(const AxisPosition& position, const AxisVelocity& velocity) noexcept;

  [[nodiscard]] double position(int axis) const noexcept { return q_[axis]; }
  [[nodiscard]] double velocity(int axis) const noexcept { return qd_[axis]; }

 private:
  /// Effect of a step on position and velocity, per initial position, velocity, effort and its
  /// slope.
  struct Transition {
    AxisMatrix position, velocity, effort, slope;
  };
  void step(const AxisColumn& effort, const AxisColumn& slope) noexcept;
  void hold(AxisColumn& position, AxisColumn& velocity) noexcept;
  void meetStops() noexcept;

  LinkedPlant plant_;
  double period_s_;
  int steps_ = 1;  ///< steps per period
  Transition to_position_, to_velocity_;
  AxisMatrix inverse_mass_;
  AxisColumn q_, qd_;
};

}  // namespace wholehand
