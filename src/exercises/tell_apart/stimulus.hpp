#pragma once

#include "loop/core/real_time.hpp"

#include <array>
#include <limits>
#include <string_view>

namespace wholehand::tell_apart {

/// What the hand feels of a bottle, beside the file's walls and liquid. At the fingertip.
struct Stimulus {
  double start_m = 0.0;    ///< depth in the shell from which on it resists
  double stiffness = 1.0;  ///< ratio on the walls' stiffness
  double viscosity = 1.0;  ///< ratio on the liquid's viscosity
  double most_n = 0.0;     ///< largest force of a digit; +inf: the wall's
  double opens_s = 0.0;    ///< time of pressing until the nozzle opens; +inf: never
};

/// A quantity that people compare: how it changes a stimulus. A new quantity is a row of kLaws and
/// an exercise file.
struct QuantityLaw {
  std::string_view name;
  /// Makes the stimulus more of this quantity. Real-time safe. @param ratio >= 1
  void (*apply)(double ratio, Stimulus& stimulus) noexcept;
  /// What a person who compares only the depth of the hand takes a deeper squeeze for: +1 more of
  /// it, -1 less.
  double deeper_means = -1.0;
};

inline constexpr std::array<QuantityLaw, 5> kLaws = {{
    {"firmer", [](double ratio, Stimulus& s) noexcept { s.stiffness *= ratio; }},
    {"thicker", [](double ratio, Stimulus& s) noexcept { s.viscosity *= ratio; }},
    {"farther", [](double ratio, Stimulus& s) noexcept { s.start_m *= ratio; }, 1.0},
    {"heavier", [](double ratio, Stimulus& s) noexcept { s.most_n *= ratio; }},
    {"later", [](double ratio, Stimulus& s) noexcept { s.opens_s *= ratio; }},
}};

}  // namespace wholehand::tell_apart
