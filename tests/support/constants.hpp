#pragma once

#include <limits>
#include <numbers>
#include <string>

/// Constants of many tests.
namespace wholehand::test {

inline const std::string kConfig = std::string(WHOLEHAND_SOURCE_DIR) + "/config/";
inline constexpr double kPeriod_s = 1e-3;   ///< of the loop
inline constexpr int kNeutralWithin = 100;  ///< ticks; 100 ms is the longest ramp allowed
inline constexpr double kPi = std::numbers::pi, kDeg = kPi / 180.0;
inline constexpr double kGravity_m_s2 = 9.81;
inline constexpr double kInfinity = std::numeric_limits<double>::infinity();

}  // namespace wholehand::test
