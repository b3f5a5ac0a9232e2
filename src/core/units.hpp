#pragma once

#include <numbers>

namespace wholehand {

inline constexpr double kDeg = std::numbers::pi / 180.0;  ///< one degree [rad]

}  // namespace wholehand
