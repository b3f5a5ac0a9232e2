#pragma once

#include "rig/engines.hpp"

#include <string>
#include <vector>

namespace wholehand {

/// Checks files and prints every fault of each. A rendering or patient file is checked against the
/// device file of the same name, else against the shipped device that it fits. Returns the exit
/// code.
int validateCommand(const std::vector<std::string>& files);

struct AdmitOptions {
  std::string scene;  ///< a scene file, or an exercise file: then its scene and the bodies of its
                      ///< game
  std::string hand, device;
  std::string rendering;  ///< empty: the file that belongs to the device
  std::string engine = defaultEngine();
  double rate_hz = 1000.0;
};

/// Measures a scene's tick on this machine and prints whether it is admitted at the rate, and if
/// not, what to remove. Returns the program's exit code.
int admitCommand(const AdmitOptions& options);

}  // namespace wholehand
