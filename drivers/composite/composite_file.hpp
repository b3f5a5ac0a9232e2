#pragma once

#include "devices/plugin/plugin_driver.hpp"
#include "loop/core/expected.hpp"

#include <array>
#include <string>
#include <vector>

namespace wholehand {

/// One of the two devices, and which of its axes belong to the whole.
struct CompositePart {
  DriverLocation driver;
  std::vector<std::string> axes;  ///< in the order in which the whole has them
};

/// What the file says that --driver-settings names; docs/composite.md shows one.
struct CompositeConfig {
  std::string path;
  double longest_skew_s = 0.005;  ///< between the times of the two samples. (0, 1]
  std::array<CompositePart, 2> parts;
};

/// Reads and checks the file. Refused, all at once: keys that nobody knows, other than two parts,
/// an axis that two parts give.
[[nodiscard]] Expected<CompositeConfig> loadCompositeFile(const std::string& path);

}  // namespace wholehand
