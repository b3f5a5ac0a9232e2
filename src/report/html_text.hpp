#pragma once

#include <string>

namespace wholehand {

/// "−3.25": fixed decimals, a true minus sign, never "−0"; "–" when not finite.
[[nodiscard]] std::string formatNumber(double value, int decimals);

}  // namespace wholehand
