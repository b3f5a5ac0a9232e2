#pragma once

#include "core/sanitized.hpp"

#include <algorithm>
#include <cstdlib>

namespace wholehand::test {

/// A tolerance times WHOLEHAND_TOL_SCALE (1 where unset): 0 shows the true residuals.
inline double tolerance(double value) {
  const char* scale = std::getenv("WHOLEHAND_TOL_SCALE");
  return scale != nullptr ? value * std::atof(scale) : value;
}

/// How many random cases to try: thirty times as many where every large count is asked for, a fifth
/// under a sanitizer. What a case computes is judged by the release build; a sanitizer looks at the
/// memory of the same code.
inline int cases(int sampled) {
  if (std::getenv("WHOLEHAND_FULL") != nullptr) return 30 * sampled;
  return WHOLEHAND_SANITIZED ? std::max(1, sampled / 5) : sampled;
}

/// The same where a case is there for the memory: damaged files and messages. As many under a
/// sanitizer.
inline int damagedCases(int sampled) {
  return std::getenv("WHOLEHAND_FULL") != nullptr ? 30 * sampled : sampled;
}

/// Whether enough cases run that how often something was seen says anything: a sanitizer sees few.
inline constexpr bool kCountsTell = WHOLEHAND_SANITIZED == 0;

}  // namespace wholehand::test
