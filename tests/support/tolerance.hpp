#pragma once

#include <cstdlib>

namespace wholehand::test {

/// A tolerance times WHOLEHAND_TOL_SCALE (1 where unset): 0 shows the true residuals.
inline double tolerance(double value) {
  const char* scale = std::getenv("WHOLEHAND_TOL_SCALE");
  return scale != nullptr ? value * std::atof(scale) : value;
}

/// How many random cases to try: thirty times as many where every large count is asked for.
inline int cases(int sampled) {
  return std::getenv("WHOLEHAND_FULL") != nullptr ? 30 * sampled : sampled;
}

}  // namespace wholehand::test
