#pragma once

#include "rig/engines.hpp"
#include "rig/models.hpp"

#include <cstdint>
#include <string>
#include <utility>
#include <vector>

namespace CLI {  // NOLINT(readability-identifier-naming): of CLI11
class App;
}

namespace wholehand {

struct ExperimentOptions {
  std::string engine = defaultEngine();
  std::string folder = "out/experiment";  ///< plots, pictures, recordings, scenes
  std::string json;                       ///< file of the results; empty: in the folder only
  int jittered = 72;                      ///< grasping: jittered trials
  std::uint64_t seed = 1;                 ///< grasping: seed of the jitter
  std::string only;  ///< grasping, complexity: runs only trials or kinds whose name contains this
  std::uint64_t ticks = 100000;  ///< timing, engines: ticks with the cylinder gripped
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
/// Compares all built-in engines in the same scenes; refused without the lab (docs/engines.md).
int enginesCommand(const ExperimentOptions& options);
/// Measures the tick in scenes of increasing size.
int complexityCommand(const ExperimentOptions& options);

/// Files of both cocktail bar experiments; empty: the shipped ones.
struct BarFiles {
  std::string exercise, hand, device, rendering, patient;
};

struct CocktailOptions {
  BarFiles files;
  std::string engine = defaultEngine();
  int seeds = 100;
  std::uint64_t first_seed = 1;
  int level = 0;                                           ///< 0: all
  int processes = 0;                                       ///< 0: one per core
  std::vector<std::pair<std::string, double>> parameters;  ///< live parameters by name
  std::string json;                                        ///< JSON file; empty: none
};

struct ExerciseOptions {
  BarFiles files;
  std::string engine = defaultEngine();
  std::uint64_t seed = 1;
  std::string folder = "out/experiment";  ///< for outputs without an explicit path
  std::string json, record, charts;
};

struct LiquidsOptions {
  BarFiles files;
  std::string folder = "out/experiment", json;
};

struct ThresholdsOptions {
  std::string fit;  ///< CSV of answers whose threshold is fitted; empty: virtual observers
  int answers = 50, blocks = 200;
  std::uint64_t seed = 1;
  std::string json;
};

struct TouchOptions {
  std::vector<std::string> files;  ///< URDFs and scenes
  std::string engine = defaultEngine();
  std::string json;
};

struct BarExperimentOptions {
  CocktailOptions cocktail;
  ExerciseOptions exercise;
  LiquidsOptions liquids;
  ThresholdsOptions thresholds;
  TouchOptions touch;
};

/// Plays the levels of the cocktail bar with many virtual patients. Returns the exit code.
int cocktailCommand(const CocktailOptions& options);
/// Reproduces the paper's Fig. 7.
int exerciseCommand(const ExerciseOptions& options);

/// Measures the felt impedance of every liquid. Returns the exit code.
int liquidsCommand(const LiquidsOptions& options);

/// Fits thresholds of feeling: of virtual observers, or of a file of answers. Returns the exit
/// code.
int thresholdsCommand(const ThresholdsOptions& options);

/// Moves every joint of objects by a touch. Returns the exit code.
int touchCommand(const TouchOptions& options);

/// Adds `wholehand experiment` with all experiments. @pre options outlive the parsing
void addExperiments(CLI::App& app, ExperimentOptions& experiment, BarExperimentOptions& bar,
                    int& code);

/// Files of a cocktail bar run; shipped files replace the empty ones.
[[nodiscard]] Expected<ModelFiles> barModelFiles(const BarFiles& files);

}  // namespace wholehand
