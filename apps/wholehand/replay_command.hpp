#pragma once

#include <string>

namespace wholehand {

struct ReplayOptions {
  std::string recording;  ///< HDF5 file or black box
  bool resimulate = false;
  std::string extract;  ///< HDF5 file to write the ticks of a black box to
  double speed = 1.0;   ///< of playing back; 1 is real time
};

/// Plays a recording or a black box back in the terminal, or runs its inputs again and compares
/// every re-simulated field bit by bit. Returns the program's exit code (kExitDifferent where they
/// differ).
int replayCommand(const ReplayOptions& options);

}  // namespace wholehand
