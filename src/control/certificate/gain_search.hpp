#pragma once

#include <functional>

namespace wholehand {

/// Largest value <= `start` that passes; 0 when none above start / 1e5 does. Steps down until a
/// value passes, then bisects to the boundary above it. The allowed set need not begin at zero.
[[nodiscard]] double largestAllowed(double start, const std::function<bool(double)>& passes);

/// The value rounded down to three digits, so that the printed number passes too. 0 unless > 0.
[[nodiscard]] double roundedDown(double value);

}  // namespace wholehand
