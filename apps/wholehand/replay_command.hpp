#pragma once

#include <string>

namespace wholehand {

struct ReplayOptions {
  std::string recording;
  bool resimulate = false;
  double speed = 1.0;  ///< of playing back; 1 is real time
};

/// Plays a recording back in the terminal, or runs its inputs again and compares every re-simulated
/// field bit by bit. Returns the program's exit code (kExitDifferent where they differ).
int replayCommand(const ReplayOptions& options);

}  // namespace wholehand
