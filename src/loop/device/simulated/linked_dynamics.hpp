#pragma once

#include "loop/core/axis_array.hpp"
#include "loop/core/real_time.hpp"
#include "loop/model/device_model.hpp"
#include "loop/model/patient_config.hpp"

#include <array>
#include <vector>

namespace wholehand {

/// One number per axis, for linear algebra; no heap.
using AxisColumn = Eigen::Matrix<double, Eigen::Dynamic, 1, Eigen::ColMajor, kMaxAxes, 1>;

/// Where an effort lies in its range: at its lower end, between, or at its upper end.
enum class RangePart : signed char { kLow, kBetween, kHigh };
using RangeParts = std::array<RangePart, kMaxAxes>;

/// Box-constrained efforts λ in lower..upper that hold axes as far as possible: with v = w + G λ on
/// each axis
///   lower < λ < upper and v = 0,  or  λ = lower and v >= 0,  or  λ = upper and v <= 0.
/// This models dry friction and stops; v are the speeds at the end of a step. Bounds may be
/// infinite. Solved by block pivots (Judice and Pires 1994), with single pivots where these make no
/// progress; terminates for positive definite G. `parts` is the initial guess and the result.
/// @pre G symmetric positive definite, lower <= upper
/// @return false if G is not positive definite or the pivots run out; λ is then the last one tried.
/// Real-time safe.
WHOLEHAND_RT bool solveBox(const AxisMatrix& g, const AxisColumn& w, const AxisColumn& lower,
                           const AxisColumn& upper, RangeParts& parts, AxisColumn& lambda) noexcept;

/// Mechanical model of axes linked by a person. SI, each axis in its own unit.
struct LinkedPlant {
  AxisMatrix mass;       ///< device and person; symmetric positive definite
  AxisMatrix damping;    ///< viscous, device and person; symmetric positive semidefinite
  AxisMatrix stiffness;  ///< stiffness of the person, towards position 0; positive semidefinite
  AxisEffort coulomb;    ///< dry friction of each axis, >= 0
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
  /// @pre the plant's arrays have one size and the properties stated there. Not real-time safe.
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

/// The axes of a device that are linked by the person's impedance. They move together while the
/// person holds them. After a slam of one axis the others stay linked; after the person lets go, no
/// axis is linked.
class LinkedPerson {
 public:
  /// @param slam_axis axis that the person may release before the others; -1: none
  LinkedPerson(const DeviceModel& device, const PatientConfig& patient, double period_s,
               int slam_axis);

  /// True when the axis currently moves linked to others. Real-time safe.
  [[nodiscard]] WHOLEHAND_RT bool moves(int axis) const noexcept { return moved_[axis]; }

  /// Sets the state with all axes held. Real-time safe.
  WHOLEHAND_RT void place(const AxisPosition& q, const AxisVelocity& qd) noexcept;

  /// Updates which axes the person holds, and their state. Real-time safe.
  WHOLEHAND_RT void hold(const std::array<bool, kMaxAxes>& held, const AxisPosition& q,
                         const AxisVelocity& qd) noexcept;

  /// Advances the linked axes by one period under their efforts. Real-time safe.
  WHOLEHAND_RT void advance(const AxisEffort& begin, const AxisEffort& end, AxisPosition& q,
                            AxisVelocity& qd) noexcept;

 private:
  struct Group {
    std::vector<int> axes;
    LinkedDynamics dynamics;
  };
  void enter(int group, const AxisPosition& q, const AxisVelocity& qd) noexcept;

  std::vector<Group> groups_;  ///< first: all linked axes; second: all but the slammed one
  int now_ = -1;               ///< current group; -1: no axis is linked
  std::array<bool, kMaxAxes> moved_{};
};

}  // namespace wholehand
