#pragma once

#include "core/axis_array.hpp"
#include "core/real_time.hpp"
#include "device/simulated/box_problem.hpp"

namespace wholehand {

/// What moves along axes that a person links. SI, each axis in its own unit.
struct LinkedPlant {
  AxisMatrix mass;            ///< device and person; symmetric positive definite
  AxisMatrix damping;         ///< viscous, of both; symmetric positive semidefinite
  AxisMatrix stiffness;       ///< of the person, towards position 0; the same
  AxisEffort coulomb;         ///< dry friction of each axis, >= 0
  AxisPosition lower, upper;  ///< stops
};

/// Axes that a person links: M q̈ + B q̇ + K q + f_c sign(q̇) = f(t), each between two inelastic
/// stops.
///
/// The linear part is advanced by its exact solution for an effort that is linear over the period,
/// in steps of at most 1/16 ms, or 1/16 of a radian of the fastest swing. Over a step dry friction
/// and stops are efforts λ that are held: what brings the axis to rest by its end, as far as it
/// may. Friction is at most f_c and never along the way, so that it only takes energy; the instant
/// at which an axis starts or stops is found to a step, not closer. A stop that is met takes the
/// speed towards it by an impulse, which the mass matrix spreads over the axes: it only takes
/// energy, too.
class LinkedDynamics {
 public:
  /// @pre one size, as LinkedPlant says  Not real-time safe.
  LinkedDynamics(const LinkedPlant& plant, double period_s);

  /// Lets one period pass; the efforts at its beginning and end, linear between them. Real-time
  /// safe.
  WHOLEHAND_RT void advance(const AxisEffort& begin, const AxisEffort& end) noexcept;

  /// Puts the axes somewhere, held inside their stops. Real-time safe.
  WHOLEHAND_RT void place(const AxisPosition& position, const AxisVelocity& velocity) noexcept;

  [[nodiscard]] double position(int axis) const noexcept { return q_[axis]; }
  [[nodiscard]] double velocity(int axis) const noexcept { return qd_[axis]; }

 private:
  /// What a step makes of position, velocity, effort and its slope at the beginning.
  struct Transition {
    AxisMatrix position, velocity, effort, slope;
  };
  void step(const AxisColumn& effort, const AxisColumn& slope) noexcept;
  void hold(AxisColumn& position, AxisColumn& velocity) noexcept;
  void meetStops() noexcept;

  LinkedPlant plant_;
  double period_s_;
  int steps_ = 1;  ///< of a period
  Transition to_position_, to_velocity_;
  AxisMatrix inverse_mass_;
  AxisColumn q_, qd_;
};

}  // namespace wholehand
