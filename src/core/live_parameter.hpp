#pragma once

#include <string>

namespace wholehand {

/// Something that may be changed while the loop runs. Every change is a ramp.
struct LiveParameter {
  std::string name;    ///< with its unit at the end: "wall_stiffness_ratio", "lead_in_m"
  std::string unit;    ///< for people, SI: "N", "m", "s", "1"
  double lower = 0.0;  ///< what may be asked for
  double upper = 0.0;
  double value = 0.0;       ///< at the start
  double rate_per_s = 0.0;  ///< slope of the ramp, > 0
};

/// The most live parameters of renderer and exercise together.
inline constexpr int kMaxLiveParameters = 24;

}  // namespace wholehand
