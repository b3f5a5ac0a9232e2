#pragma once

#include "core/axis_array.hpp"
#include "core/real_time.hpp"

#include <array>

namespace wholehand {

/// A movement of the hand from wherever it is, however fast, to rest at a goal: per axis the
/// polynomial of fifth degree that begins with its position and speed and no acceleration. From
/// rest that is minimum jerk (Flash and Hogan 1985). Axes may move in a part of the time only.
class Reach {
 public:
  /// All axes over the whole duration. @pre arrays of one size, duration_s > 0. Real-time safe.
  WHOLEHAND_RT void begin(const AxisPosition& q, const AxisVelocity& qd, const AxisPosition& goal,
                          double duration_s) noexcept;

  /// This axis moves from `from` to `to` alone, as shares of the duration. One that moves already
  /// cannot wait: it begins at once. @pre 0 <= from < to <= 1. Real-time safe.
  WHOLEHAND_RT void during(int axis, double from, double to) noexcept;

  /// One period later. Real-time safe.
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
