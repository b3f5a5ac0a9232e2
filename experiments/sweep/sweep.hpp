#pragma once

#include "experiments/sweep/cell.hpp"
#include "experiments/sweep/grid.hpp"

#include <functional>
#include <optional>
#include <string>
#include <vector>

namespace wholehand {

/// A part of a grid's cells: those whose index is `first` modulo `step`.
struct SweepShare {
  int first = 0, step = 1;
};

struct SweepPlan {
  std::string out;  ///< HDF5 file of the results; beside it stands a folder of finished cells
  std::string git_version;
  int processes = 1;
  std::optional<SweepShare> share;  ///< of several programs that work on one grid
  FindFile find;
  /// Called in the calling process after each finished cell.
  std::function<void(int finished, int all)> progress = {};
};

struct SweepOutcome {
  int cells = 0;     ///< of the grid
  int finished = 0;  ///< of the grid, by whomever
  int run = 0;       ///< by this call
  bool interrupted = false;
  bool written = false;      ///< the file of the results is complete
  std::vector<int> refused;  ///< cells that gave an error instead of figures
  Diagnostics refusals;      ///< the first of those errors
  bool died = false;         ///< a process that ran cells died
};

/// Runs the cells that are not finished yet and, when all are, writes the file. The file's bytes do
/// not depend on who ran which cell. Call before any thread is started.
[[nodiscard]] Expected<SweepOutcome> runSweep(const SweepGrid& grid, const SweepPlan& plan);

/// Table of a map: mean of a figure over every axis but two.
[[nodiscard]] std::vector<std::vector<double>> mapOf(const SweepGrid& grid, const SweepMap& map,
                                                     const std::vector<double>& figure);

}  // namespace wholehand
