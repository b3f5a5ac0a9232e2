#pragma once

#include "loop/core/compiler.hpp"

#include <algorithm>
#include <cstdlib>

namespace wholehand::test {

/// A tolerance times WHOLEHAND_TOL_SCALE (1 if unset); 0 shows the true residuals.
inline double tolerance(double value) {
  const char* scale = std::getenv("WHOLEHAND_TOL_SCALE");
  return scale != nullptr ? value * std::atof(scale) : value;
}

/// True if ./check --full runs.
inline bool underFull() {
  static const bool full = std::getenv("WHOLEHAND_FULL") != nullptr;
  return full;
}

/// True if every large count is requested. Under a sanitizer ./check --full uses the usual counts.
inline bool fullCounts() {
  return underFull() && WHOLEHAND_SANITIZED == 0;
}

/// True with reduced counts: as ./check runs unit tests (tests/CMakeLists.txt), and under a
/// sanitizer. ./check --full runs them in a release build with every large count.
inline const bool kReducedCounts =
    !underFull() &&
    (WHOLEHAND_SANITIZED != 0 || std::getenv("WHOLEHAND_REDUCED_COUNTS") != nullptr);

/// True under a sanitizer, which judges memory: the release build judges rare cases.
inline constexpr bool kSanitized = WHOLEHAND_SANITIZED != 0;

/// Number of random cases to try: thirty times as many with full counts, a tenth with
/// kReducedCounts, a fortieth under a sanitizer.
inline int cases(int sampled) {
  if (kReducedCounts) return std::max(1, sampled / (kSanitized ? 40 : 10));
  return fullCounts() ? 30 * sampled : sampled;
}

/// The same for cases that test memory safety (damaged files and messages), which are not reduced
/// under a sanitizer.
inline int damagedCases(int sampled) {
  return underFull() ? 30 * sampled : sampled;
}

/// True if enough cases run for frequencies to be meaningful.
inline const bool kStatisticsMeaningful = !kReducedCounts;

}  // namespace wholehand::test
