#pragma once

#include <algorithm>
#include <cmath>

namespace wholehand {

/// 0 before `from`, 1 after `to` (which may lie before `from`), without a kink between.
inline double smoothStep(double from, double to, double x) noexcept {
  const double t = std::clamp((x - from) / (to - from), 0.0, 1.0);
  return t * t * (3.0 - 2.0 * t);
}

/// Polynomial smooth minimum of width k > 0: differs from min only where |a - b| < k, and there by
/// at most k/4.
inline double smoothMin(double a, double b, double k) noexcept {
  const double h = std::max(k - std::abs(a - b), 0.0);
  return std::min(a, b) - h * h / (4.0 * k);
}

inline double smoothMax(double a, double b, double k) noexcept {
  return -smoothMin(-a, -b, k);
}

}  // namespace wholehand
