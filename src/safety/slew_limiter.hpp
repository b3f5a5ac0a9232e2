#pragma once

#include "safety/force_limiter.hpp"

#include <array>

namespace wholehand {

/// The slew limit holds over this time: a person and a mechanism cannot tell a step from a rise
/// within it, and the step of a damper at an impact is as high at every rate.
inline constexpr double kSlewWindow_s = 1e-3;
inline constexpr int kMostSlewTicks = 16;

/// Whole periods in kSlewWindow_s, 1 to kMostSlewTicks.
[[nodiscard]] int slewTicks(double period_s) noexcept;

/// The efforts sent in the last periods. Real-time safe.
class SlewWindow {
 public:
  /// @param ticks 1 .. kMostSlewTicks: of how many it knows
  explicit SlewWindow(int ticks = 1) noexcept : ticks_(ticks) {}

  WHOLEHAND_RT void clear() noexcept { count_ = 0; }
  WHOLEHAND_RT void note(const AxisEffort& sent) noexcept;

  [[nodiscard]] WHOLEHAND_RT double newest(int axis) const noexcept {
    return sent_[static_cast<std::size_t>(newest_)][axis];
  }
  [[nodiscard]] WHOLEHAND_RT double least(int axis) const noexcept;
  [[nodiscard]] WHOLEHAND_RT double most(int axis) const noexcept;

 private:
  int ticks_, count_ = 0, newest_ = 0;
  std::array<AxisEffort, kMostSlewTicks> sent_{};
};

/// Holds every effort within most_change of all that were sent in the window (Fault::kEffortSlew,
/// information): the last thing before the device, so that nothing whatever makes a blow, not a
/// longer one after a stall either. Pure, real-time safe.
/// @param effort finite @param last not empty @param most_change > 0 in the window
[[nodiscard]] WHOLEHAND_RT LimitedEffort limitSlew(const AxisEffort& effort, const SlewWindow& last,
                                                   const AxisEffort& most_change) noexcept;

}  // namespace wholehand
