#pragma once

#include "assembly/engines.hpp"

#include <string>

namespace wholehand {

struct AdmitOptions {
  std::string scene;  ///< a scene file, or an exercise file: its scene, and the bodies of its game
  std::string hand, device;
  std::string rendering;  ///< empty: what goes with the device
  std::string engine = defaultEngine();
  double rate_hz = 1000.0;
};

/// Measures a scene's tick on this machine and says whether it is admitted at the rate, and what to
/// remove where it is not. Returns the program's exit code.
int admitCommand(const AdmitOptions& options);

}  // namespace wholehand
