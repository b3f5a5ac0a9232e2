#pragma once

#include <algorithm>

namespace wholehand {

/// Interval of a measured figure, in its own unit.
struct Interval {
  double lower = 0.0, upper = 0.0;

  [[nodiscard]] bool contains(double value) const { return value >= lower && value <= upper; }
  [[nodiscard]] double middle() const { return 0.5 * (lower + upper); }
  [[nodiscard]] double halfWidth() const { return 0.5 * (upper - lower); }
};

/// The smallest interval that holds both.
[[nodiscard]] inline Interval hull(const Interval& a, const Interval& b) {
  return {std::min(a.lower, b.lower), std::max(a.upper, b.upper)};
}

}  // namespace wholehand
