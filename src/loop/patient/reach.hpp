#pragma once

#include "loop/core/axis_array.hpp"
#include "loop/core/real_time.hpp"

#include <array>

namespace wholehand {

/// Peak over mean speed of a minimum-jerk movement.
inline constexpr double kMinimumJerkPeak = 1.875;

/// A reaching movement from any position and speed to rest at a goal: per axis a fifth-order
/// polynomial that begins at its position and speed with zero acceleration. From rest it is minimum
/// jerk (Flash and Hogan 1985). An axis may move during part of the time only.
class Reach {
 public:
  /// Begins a movement of all axes over the whole duration. @pre arrays of one size, duration_s >
  /// 0. Real-time safe.
  WHOLEHAND_RT void begin(const AxisPosition& q, const AxisVelocity& qd, const AxisPosition& goal,
                          double duration_s) noexcept;

  /// Restricts an axis to the part `from` .. `to` of the duration. An axis already in motion begins
  /// at once. @pre 0 <= from < to <= 1. Real-time safe.
  WHOLEHAND_RT void during(int axis, double from, double to) noexcept;

  /// Lengthens the whole movement until the axis, starting from rest, is no faster than this speed.
  /// Call after during().
  WHOLEHAND_RT void limitSpeed(int axis, double speed) noexcept;

  /// Advances one period. Real-time safe.
  WHOLEHAND_RT void advance(double period_s, AxisPosition& q, AxisVelocity& qd) noexcept;

  [[nodiscard]] bool done() const noexcept { return time_s_ >= duration_s_; }
  [[nodiscard]] const AxisPosition& goal() const noexcept { return goal_; }

 private:
  struct Window {
    double from_s = 0.0, to_s = 0.0;
  };
  AxisPosition start_, goal_;
  AxisVelocity start_speed_;
  std::array<Window, kMaxAxes> windows_{};
  double duration_s_ = 0.0, time_s_ = 0.0;
};

}  // namespace wholehand
