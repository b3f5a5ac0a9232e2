#pragma once

#include "loop/core/expected.hpp"
#include "motor_map.hpp"

#include <string>
#include <vector>

namespace wholehand::moteus {

/// Settings file of the driver: the motors, and how they move the axes.
struct Settings {
  std::string path;
  double delay_s = 0.0;  ///< from a write to its effect, including the age of a sample
  std::vector<Motor> motors;
  std::vector<MotorAxis> axes;
};

/// Reads the file. Refused, all at once: unknown keys and numbers out of range; two motors with one
/// name or identifier; an axis without its own motor; a coupling to an axis that is not before it;
/// travel beyond half a turn of a motor, whose position is ambiguous after switching on; effort
/// limits that a motor cannot give. Not for the tick.
[[nodiscard]] Expected<Settings> loadSettings(const std::string& path);

}  // namespace wholehand::moteus
