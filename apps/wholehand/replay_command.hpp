#pragma once

#include <string>

namespace wholehand {

struct ReplayOptions {
  std::string recording;  ///< HDF5 file or black box
  bool resimulate = false;
  std::string extract;  ///< HDF5 file to write the ticks of a black box to
  std::string report;   ///< HTML file to write instead of playing it
  std::string before;   ///< with a report: recording of the session before
  double speed = 1.0;   ///< of playing back; 1 is real time
  bool web = false;     ///< in the browser
  std::string beside;   ///< HDF5 file to show beside it in the browser
  int port = 8080;      ///< of the browser's pages; 0: any that is free
  bool answer = false;  ///< the questions on standard input: the process that replay_children runs
};

/// Plays a recording or a black box back in the terminal, or runs its inputs again and compares
/// every re-simulated field bit by bit. Returns the program's exit code (kExitDifferent where they
/// differ).
int replayCommand(const ReplayOptions& options);

}  // namespace wholehand
