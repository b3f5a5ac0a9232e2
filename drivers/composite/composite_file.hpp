#pragma once

#include "devices/plugin/plugin_driver.hpp"
#include "loop/core/expected.hpp"

#include <array>
#include <string>
#include <vector>

namespace wholehand {

/// One of the two devices, and its axes that belong to the whole.
struct CompositePart {
  DriverLocation driver;
  double longest_gap_s = 0.02;    ///< longest time without a new sample [s], in (0, 10]
  std::vector<std::string> axes;  ///< in the order of the whole
};

/// Contents of the file that --driver-settings names; docs/composite.md shows one.
struct CompositeConfig {
  std::string path;
  double longest_skew_s = 0.005;  ///< largest time between the two samples [s], in (0, 1]
  std::array<CompositePart, 2> parts;
};

/// Reads and checks the file. Refused, all at once: unknown keys, a number of parts other than two,
/// and an axis that both parts have.
[[nodiscard]] Expected<CompositeConfig> loadCompositeFile(const std::string& path);

}  // namespace wholehand
