#pragma once

#include "assembly/engines.hpp"

#include <cstdint>
#include <string>

namespace wholehand {

struct ExperimentOptions {
  std::string engine = defaultEngine();
  std::string folder = "out/experiment";  ///< plots, pictures, recordings, scenes
  std::string json;                       ///< results; empty: only in the folder
  int jittered = 72;                      ///< grasping: jittered trials
  std::uint64_t seed = 1;                 ///< grasping: of the jitter
  std::string only;                       ///< grasping: part of a trial's name
  std::uint64_t ticks = 100000;           ///< timing
  std::string scene;                      ///< timing: instead of the bar; its first body is gripped
  bool simulated_clock = false;           ///< timing: as fast as it goes
  double hold_s = 2.0;                    ///< engines: how long is held and rested
};

/// The paper's Fig. 5. Returns the program's exit code.
int graspingCommand(const ExperimentOptions& options);
/// The paper's Fig. 6.
int timingCommand(const ExperimentOptions& options);
/// Every engine that is built in, in the same scenes (docs/engines.md).
int enginesCommand(const ExperimentOptions& options);

}  // namespace wholehand
