#pragma once

#include "core/real_time.hpp"
#include "core/tick_record.hpp"

#include <array>
#include <vector>

namespace wholehand {

/// Live parameters that ramp towards their targets, each at most at its rate.
class ParameterRamps {
 public:
  /// @pre at most kMaxLiveParameters; rates > 0
  explicit ParameterRamps(const std::vector<LiveParameter>& parameters);

  /// Sets a parameter's value at reset() instead of its default. Ignores unknown indices, NaN and
  /// values out of range.
  void startAt(int index, double value) noexcept;
  /// Sets every parameter to its start value.
  void reset() noexcept;
  /// Sets a parameter's target. Ignores unknown indices, NaN and values out of range. Real-time
  /// safe.
  WHOLEHAND_RT void ask(int index, double value) noexcept;
  /// Advances the ramps by one tick. Real-time safe.
  WHOLEHAND_RT void advance(int elapsed_periods, double period_s) noexcept;

  [[nodiscard]] int count() const noexcept { return count_; }
  [[nodiscard]] const double* values() const noexcept { return value_.data(); }
  [[nodiscard]] const double* atStart() const noexcept { return initial_.data(); }

 private:
  using Values = std::array<double, kMaxLiveParameters>;
  int count_ = 0;
  Values lower_{}, upper_{}, rate_per_s_{}, initial_{}, value_{}, wanted_{};
};

}  // namespace wholehand
