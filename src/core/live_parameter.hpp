#pragma once

#include <string>

namespace wholehand {

/// A setting that may change while the loop runs. Every change is a ramp.
struct LiveParameter {
  std::string name;    ///< with its unit at the end: "wall_stiffness_ratio", "lead_in_m"
  std::string unit;    ///< for people, SI: "N", "m", "s", "1"
  double lower = 0.0;  ///< allowed range, lower .. upper
  double upper = 0.0;
  double value = 0.0;       ///< initial value
  double rate_per_s = 0.0;  ///< slope of the ramp, > 0
};

/// Most live parameters of renderer and exercise together.
inline constexpr int kMaxLiveParameters = 24;

}  // namespace wholehand
