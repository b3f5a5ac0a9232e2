#pragma once

#include "core/real_time.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <vector>

namespace wholehand {

/// Delay line of fixed length. Memory is allocated in the constructor.
template <class Value>
class DelayLine {
 public:
  /// Rounds the delay to whole periods. Not real-time safe.
  DelayLine(double delay_s, double period_s)
      : values_(std::max(std::lround(delay_s / period_s), 0L) + 1) {}

  /// Fills the history with a value. Real-time safe.
  WHOLEHAND_RT void fill(const Value& value) noexcept {
    std::fill(values_.begin(), values_.end(), value);
    newest_ = 0;
  }

  /// Stores the present value and returns the delayed one. Once a period. Real-time safe.
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
