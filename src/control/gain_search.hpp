#pragma once

#include <functional>

namespace wholehand {

/// Largest value <= `start` that passes, 0 when none above start / 1e5 does: walks down until one
/// passes, then bisects to the boundary above it (the allowed set need not begin at zero).
[[nodiscard]] double largestAllowed(double start, const std::function<bool(double)>& passes);

/// Rounded down to three digits, so that the number, typed into a file, passes. 0 unless > 0.
[[nodiscard]] double roundedDown(double value);

}  // namespace wholehand
