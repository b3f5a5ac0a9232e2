#pragma once

#include "loop/core/compiler.hpp"

#include <algorithm>
#include <cstdlib>

namespace wholehand::test {

/// A tolerance times WHOLEHAND_TOL_SCALE (1 where unset): 0 shows the true residuals.
inline double tolerance(double value) {
  const char* scale = std::getenv("WHOLEHAND_TOL_SCALE");
  return scale != nullptr ? value * std::atof(scale) : value;
}

/// Whether ./check --full runs.
inline bool underFull() {
  static const bool full = std::getenv("WHOLEHAND_FULL") != nullptr;
  return full;
}

/// Whether every large count is asked for. A sanitizer has the usual ones in ./check --full.
inline bool fullCounts() {
  return underFull() && WHOLEHAND_SANITIZED == 0;
}

/// Whether a sanitizer runs, and not at the usual counts: ./check judges unit tests so. ./check
/// --full judges them in a release build, at every large count.
inline const bool kFew = WHOLEHAND_SANITIZED != 0 && !underFull();

/// How many random cases to try: thirty times as many where every large count is asked for, a tenth
/// in ./check.
inline int cases(int sampled) {
  if (kFew) return std::max(1, sampled / 10);
  return fullCounts() ? 30 * sampled : sampled;
}

/// The same where a case is there for the memory: damaged files and messages. As many under a
/// sanitizer.
inline int damagedCases(int sampled) {
  return underFull() ? 30 * sampled : sampled;
}

/// Whether enough cases run that how often something was seen says anything.
inline const bool kCountsTell = !kFew;

}  // namespace wholehand::test
