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

/// Whether every large count is asked for (./check --full).
inline bool fullCounts() {
  return std::getenv("WHOLEHAND_FULL") != nullptr;
}

/// Whether a sanitizer runs at counts for everyday: ./check judges unit tests there and nowhere
/// else. ./check --full judges them in a release build at every large count besides.
inline const bool kFew = WHOLEHAND_SANITIZED != 0 && !fullCounts();

/// How many random cases to try: a tenth under a sanitizer, thirty times as many in a release build
/// where every large count is asked for.
inline int cases(int sampled) {
  if (kFew) return std::max(1, sampled / 10);
  return fullCounts() && !WHOLEHAND_SANITIZED ? 30 * sampled : sampled;
}

/// The same where a case is there for the memory: damaged files and messages. As many under a
/// sanitizer.
inline int damagedCases(int sampled) {
  return fullCounts() ? 30 * sampled : sampled;
}

/// Whether enough cases run that how often something was seen says anything.
inline const bool kCountsTell = !kFew;

}  // namespace wholehand::test
