#pragma once

#include <cmath>

namespace wholehand {

/// The nearest multiple of a step, halves to even; exact where the step is a power of two. A zero
/// is positive; infinity and NaN stay. Real-time safe.
[[nodiscard]] inline double onGrid(double value, double step) noexcept {
  return std::nearbyint(value / step) * step + 0.0;
}

}  // namespace wholehand
