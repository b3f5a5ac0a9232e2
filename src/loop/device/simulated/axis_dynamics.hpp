#pragma once

#include "loop/core/real_time.hpp"

#include <Eigen/Core>

#include <array>

namespace wholehand {

/// Computes e^m of a square matrix by Eigen's scaling and squaring with Padé approximants.
/// Allocates.
[[nodiscard]] Eigen::MatrixXd matrixExponential(const Eigen::MatrixXd& m);

/// Mechanical model of one axis. SI; per radian for a rotation.
struct AxisPlant {
  double mass = 1.0;       ///< [kg or kg·m²], > 0
  double damping = 0.0;    ///< viscous, device and person [N·s/m or N·m·s/rad], >= 0
  double stiffness = 0.0;  ///< stiffness of the person, towards position 0 [N/m or N·m/rad], >= 0
  double coulomb = 0.0;    ///< dry friction [N or N·m], >= 0
  double lower = 0.0, upper = 0.0;  ///< stops [m or rad]
};

/// An effort that changes linearly over a period [N or N·m].
struct EffortRamp {
  double begin = 0.0, end = 0.0;
};

/// One axis: m q̈ + b q̇ + k q + f_c sign(q̇) = f(t) between two inelastic stops.
///
/// The linear part is advanced by its exact solution for an effort that is linear over the period,
/// for any period. Within a period the instants of zero velocity or of impact on a stop are found
/// to one part in 2^20 by halving the step. The axis then sticks until the other efforts exceed
/// f_c, and breaks away at that instant.
class AxisDynamics {
 public:
  /// Not real-time safe.
  AxisDynamics(const AxisPlant& plant, double period_s);

  /// Advances by one period. Real-time safe.
  WHOLEHAND_RT void advance(EffortRamp effort) noexcept;

  /// Sets the state, clamped to the stops. Real-time safe.
  WHOLEHAND_RT void place(double position, double velocity) noexcept;

  [[nodiscard]] double position() const noexcept { return q_; }
  [[nodiscard]] double velocity() const noexcept { return qd_; }

 private:
  /// q and q̇ after a step, as linear functions of q, q̇, the effort and its slope at the beginning.
  struct Transition {
    std::array<double, 4> position{}, velocity{};
  };
  struct State {
    double q, qd;
  };
  /// A period is 2^kLevels grains; transitions_[j] spans 2^j of them.
  static constexpr int kLevels = 20;
  static constexpr int kGrains = 1 << kLevels;
  /// Largest number of changes between sticking and sliding in one period; after them the axis
  /// sticks until the next period.
  static constexpr int kMostEvents = 32;

  [[nodiscard]] double effortAt(int grain) const noexcept;
  [[nodiscard]] State after(int level, int grain, double direction) const noexcept;
  [[nodiscard]] bool canHold() const noexcept;
  [[nodiscard]] bool held(int grain) const noexcept;
  [[nodiscard]] int slide(int grain, double direction) noexcept;
  [[nodiscard]] int stickUntil(int grain) const noexcept;

  AxisPlant plant_;
  double grain_s_;
  std::array<Transition, kLevels + 1> transitions_{};
  EffortRamp effort_;
  double q_ = 0.0, qd_ = 0.0;
};

}  // namespace wholehand
