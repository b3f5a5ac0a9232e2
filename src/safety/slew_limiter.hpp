#pragma once

#include "safety/force_limiter.hpp"

#include <array>

namespace wholehand {

/// Window of the slew limit. Within it, neither a person nor a mechanism can distinguish a step
/// from a ramp, and a damper's step at an impact is equally high at every rate.
inline constexpr double kSlewWindow_s = 1e-3;
inline constexpr int kMostSlewTicks = 16;

/// Number of whole periods in kSlewWindow_s, 1 to kMostSlewTicks.
[[nodiscard]] int slewTicks(double period_s) noexcept;

/// The efforts sent in the last periods. Real-time safe.
class SlewWindow {
 public:
  /// @param ticks number of efforts to remember, 1 .. kMostSlewTicks
  explicit SlewWindow(int ticks = 1) noexcept : ticks_(ticks) {}

  WHOLEHAND_RT void clear() noexcept { count_ = 0; }
  WHOLEHAND_RT void note(const AxisEffort& sent) noexcept;

  [[nodiscard]] WHOLEHAND_RT double newest(int axis) const noexcept { return sent_[newest_][axis]; }
  [[nodiscard]] WHOLEHAND_RT double least(int axis) const noexcept;
  [[nodiscard]] WHOLEHAND_RT double most(int axis) const noexcept;

 private:
  int ticks_, count_ = 0, newest_ = 0;
  std::array<AxisEffort, kMostSlewTicks> sent_{};
};

/// Keeps every effort within most_change of all efforts sent in the window (Fault::kEffortSlew,
/// information). Last step before the device: nothing, a longer stall included, can cause a blow.
/// Pure, real-time safe.
/// @param effort finite @param last not empty @param most_change > 0 within the window
[[nodiscard]] WHOLEHAND_RT LimitedEffort limitSlew(const AxisEffort& effort, const SlewWindow& last,
                                                   const AxisEffort& most_change) noexcept;

}  // namespace wholehand
