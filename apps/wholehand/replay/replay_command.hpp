#pragma once

#include <string>

namespace wholehand {

struct ReplayOptions {
  std::string recording;  ///< HDF5 file or black box file
  bool resimulate = false;
  std::string extract;  ///< HDF5 file for the ticks of a black box file
  std::string report;   ///< HTML file to write instead of playing back
  std::string before;   ///< with a report: recording of the previous session
  double speed = 1.0;   ///< playback speed; 1 is real time
  bool web = false;     ///< play back in the browser
  std::string beside;   ///< second HDF5 file, shown side by side in the browser
  int port = 8080;      ///< port of the pages; 0: any free port
  bool answer = false;  ///< answer questions on standard input, for the process that
                        ///< replay_children runs
};

/// Plays a recording or a black box file back in the terminal, or runs its inputs again and
/// compares every re-simulated field bit by bit. Returns the exit code (kExitDifferent when they
/// differ).
int replayCommand(const ReplayOptions& options);

/// Serves pages with one recording, or two side by side, until Ctrl-C, without a loop or a device.
/// Returns the exit code.
int replayWebCommand(const ReplayOptions& options);

}  // namespace wholehand
