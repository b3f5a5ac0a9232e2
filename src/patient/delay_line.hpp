#pragma once

#include "core/real_time.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <vector>

namespace wholehand {

/// What was given a fixed time ago. Its room is taken when it is made.
template <class Value>
class DelayLine {
 public:
  /// To the nearest whole number of periods. Not real-time safe.
  DelayLine(double delay_s, double period_s)
      : values_(static_cast<std::size_t>(std::max(std::lround(delay_s / period_s), 0L)) + 1) {}

  /// As if it had always been this. Real-time safe.
  WHOLEHAND_RT void fill(const Value& value) noexcept {
    std::fill(values_.begin(), values_.end(), value);
    newest_ = 0;
  }

  /// Once a period: takes the present value, gives the one of `delay` ago. Real-time safe.
  WHOLEHAND_RT const Value& shift(const Value& value) noexcept {
    newest_ = (newest_ + 1) % values_.size();
    values_[newest_] = value;
    return values_[(newest_ + 1) % values_.size()];
  }

 private:
  std::vector<Value> values_;
  std::size_t newest_ = 0;
};

}  // namespace wholehand
