#pragma once

#include "assembly/engines.hpp"

#include <cstdint>
#include <string>
#include <vector>

namespace wholehand {

struct ExperimentOptions {
  std::string engine = defaultEngine();
  std::string folder = "out/experiment";  ///< plots, pictures, recordings, scenes
  std::string json;                       ///< results; empty: in the folder only
  int jittered = 72;                      ///< grasping: jittered trials
  std::uint64_t seed = 1;                 ///< grasping: seed of the jitter
  std::string only;  ///< grasping, complexity: runs trials or kinds whose name contains this
  std::uint64_t ticks = 100000;  ///< timing
  std::string scene;             ///< timing: replaces the bar; its first body is gripped
  bool simulated_clock = false;  ///< timing: run as fast as possible
  double hold_s = 2.0;           ///< engines: duration of holding and of resting
  std::vector<double> rates_hz = {1000.0, 2000.0, 4000.0, 8000.0};  ///< engines
  int scene_ticks = 3000;  ///< complexity: ticks of each scene
  int passes = 3;          ///< complexity: runs of each scene
};

/// Reproduces the paper's Fig. 5. Returns the exit code.
int graspingCommand(const ExperimentOptions& options);
/// Reproduces the paper's Fig. 6.
int timingCommand(const ExperimentOptions& options);
/// Compares all built-in engines in the same scenes (docs/engines.md).
int enginesCommand(const ExperimentOptions& options);
/// Measures the tick in scenes of increasing size.
int complexityCommand(const ExperimentOptions& options);

}  // namespace wholehand
