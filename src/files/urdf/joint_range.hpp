#pragma once

#include <limits>
#include <optional>
#include <string>
#include <string_view>

namespace wholehand {

/// The range of a joint that a URDF's <limit> gives [rad; m].
struct JointRange {
  double least = -std::numeric_limits<double>::infinity();
  double most = std::numeric_limits<double>::infinity();
  bool moves = true;            ///< false: both ends are one place
  bool refused = false;         ///< `problem` is a fault, of the end that `end` names
  const char* end = nullptr;    ///< "lower", "upper"; nullptr: of both
  std::string problem, remedy;  ///< a notice unless refused; empty: the file's range as it stands
};

/// Largest ends of a range: as places in a scene; two turns.
inline constexpr double kMostSlide_m = 10.0;
inline constexpr double kMostHinge_rad = 12.566370614359172;

/// Reads the ends of a revolute or prismatic joint. Public files say "no end" in several ways: no
/// ends at all, 1 .. 0 and 1 .. -1 (Bullet), ends that nothing reaches (1e16). A hinge without an
/// end turns on; a slide ends at kMostSlide_m. What may be degrees or millimetres is refused.
/// @param lower, upper as in the file, infinity included; empty: not given
[[nodiscard]] JointRange jointRange(bool slides, std::optional<double> lower,
                                    std::optional<double> upper);

/// A number of a <limit>, which may be infinite ("inf"); empty: neither.
[[nodiscard]] std::optional<double> limitEnd(std::string_view text);

}  // namespace wholehand
