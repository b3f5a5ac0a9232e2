#pragma once

#include "assembly/engines.hpp"
#include "assembly/models.hpp"

#include <CLI/CLI.hpp>

#include <cstdint>
#include <string>

namespace wholehand {

/// Files of both cocktail bar experiments; empty: the shipped ones.
struct BarFiles {
  std::string exercise, hand, device, rendering, patient;
};

struct CocktailOptions {
  BarFiles files;
  std::string engine = defaultEngine();
  int seeds = 100;
  std::uint64_t first_seed = 1;
  int level = 0;      ///< 0: all
  int processes = 0;  ///< 0: one per core
  std::string json;   ///< empty: none
};

struct ExerciseOptions {
  BarFiles files;
  std::string engine = defaultEngine();
  std::uint64_t seed = 1;
  std::string folder = "out/experiment";  ///< for outputs without an explicit path
  std::string json, record, charts;
};

struct BarExperimentOptions {
  CocktailOptions cocktail;
  ExerciseOptions exercise;
};

/// Plays the levels of the cocktail bar with many virtual patients. Returns the exit code.
int cocktailCommand(const CocktailOptions& options);
/// Reproduces the paper's Fig. 7.
int exerciseCommand(const ExerciseOptions& options);

/// Adds both commands to `wholehand experiment`. @pre options outlive the parsing
void addBarExperiments(CLI::App& experiment, BarExperimentOptions& options, int& code);

/// Files of a cocktail bar run; unnamed ones are the shipped ones.
[[nodiscard]] Expected<ModelFiles> barModelFiles(const BarFiles& files);

}  // namespace wholehand
