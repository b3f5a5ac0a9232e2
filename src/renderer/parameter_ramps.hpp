#pragma once

#include "core/live_parameter.hpp"
#include "core/real_time.hpp"

#include <array>
#include <vector>

namespace wholehand {

/// Live parameters on their way to where somebody wants them: each moves by at most its rate.
class ParameterRamps {
 public:
  /// @pre at most kMaxLiveParameters; rates > 0
  explicit ParameterRamps(const std::vector<LiveParameter>& parameters);

  /// Where a parameter is after reset(), instead of its own value. Unknown indices, values out of
  /// range and values that are no numbers change nothing.
  void startAt(int index, double value) noexcept;
  /// Back to the values at the start.
  void reset() noexcept;
  /// Lets a parameter go towards a value. Unknown indices, values out of range and values that are
  /// no numbers change nothing. Real-time safe.
  WHOLEHAND_RT void ask(int index, double value) noexcept;
  /// One tick. Real-time safe.
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
