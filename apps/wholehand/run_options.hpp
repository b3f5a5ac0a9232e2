#pragma once

#include "assembly/models.hpp"

#include <string>

namespace wholehand {

/// What `wholehand run` was asked for.
struct RunOptions {
  ModelFiles files;
  std::string engine = "bullet";
  double rate_hz = 1000.0;
  double duration_s = 0.0;  ///< 0: until the motion has been played
  std::string record;       ///< HDF5 file; empty: none
  std::string report;       ///< folder; empty: none
  std::string json;         ///< file; empty: none
  bool simulated_clock = false;
  bool uncertified = false;
};

/// Plays a motion through the whole of Wholehand. Returns the program's exit code.
int runCommand(RunOptions options);

}  // namespace wholehand
