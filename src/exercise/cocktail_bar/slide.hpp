#pragma once

#include "core/real_time.hpp"

#include <algorithm>

namespace wholehand {

/// A minimum-jerk slide from 0 to 1 that can be frozen: it stops at once and restarts smoothly.
struct Slide {
  double duration_s = 0.0;  ///< 0: no slide
  double time_s = 0.0;      ///< time along the slide, stopped while frozen
  double pace = 0.0;        ///< 0 frozen, 1 as planned

  [[nodiscard]] bool active() const noexcept { return duration_s > 0.0 && time_s < duration_s; }
  /// 10 u³ − 15 u⁴ + 6 u⁵
  [[nodiscard]] WHOLEHAND_RT double share() const noexcept {
    const double u = duration_s > 0.0 ? std::clamp(time_s / duration_s, 0.0, 1.0) : 1.0;
    return u * u * u * (10.0 + u * (6.0 * u - 15.0));
  }
  /// Present rate of share() [1/s].
  [[nodiscard]] WHOLEHAND_RT double rate_per_s() const noexcept {
    if (!active()) return 0.0;
    const double u = time_s / duration_s;
    return pace * 30.0 * u * u * (1.0 - u) * (1.0 - u) / duration_s;
  }
  WHOLEHAND_RT void advance(bool may_move, double elapsed_s) noexcept {
    constexpr double kStart_s = 0.15;
    pace = may_move ? std::min(1.0, pace + elapsed_s / kStart_s) : 0.0;
    if (active()) time_s = std::min(duration_s, time_s + pace * elapsed_s);
  }
};

/// Peak over mean speed of a minimum-jerk slide.
inline constexpr double kMinimumJerkPeak = 1.875;

}  // namespace wholehand
