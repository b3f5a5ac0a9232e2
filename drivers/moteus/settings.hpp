#pragma once

#include "loop/core/expected.hpp"
#include "motor_map.hpp"

#include <string>
#include <vector>

namespace wholehand::moteus {

/// The settings file of the driver: which motors there are and how they move the axes.
struct Settings {
  std::string path;
  double delay_s = 0.0;  ///< from a write to its effect, the age of a sample included
  std::vector<Motor> motors;
  std::vector<MotorAxis> axes;
};

/// Reads the file under strict reading. Refused, all at once: unknown keys and numbers out of
/// range; two motors with one name or identifier; an axis without a motor of its own; a coupling to
/// no axis before it; travel beyond half a turn of a motor, which reads the same at both ends of a
/// turn after it was switched on; effort limits that a motor cannot give. Not for the tick.
[[nodiscard]] Expected<Settings> loadSettings(const std::string& path);

}  // namespace wholehand::moteus
