#pragma once

#include "experiments/sweep/cell.hpp"
#include "experiments/sweep/grid.hpp"

#include <functional>
#include <optional>
#include <string>
#include <vector>

namespace wholehand {

/// Part of a grid's cells: those whose index is `first` modulo `step`.
struct SweepShare {
  int first = 0, step = 1;
};

struct SweepPlan {
  std::string out;  ///< HDF5 result file; the journal of finished cells is a folder next to it
  std::string git_version;
  int processes = 1;
  std::optional<SweepShare> share;  ///< share of this program, if several programs work on one grid
  FindFile find;
  /// Called in the calling process after each finished cell.
  std::function<void(int finished, int all)> progress = {};
};

struct SweepOutcome {
  int cells = 0;     ///< number of cells of the grid
  int finished = 0;  ///< finished cells of the grid, by any program
  int run = 0;       ///< cells run by this call
  bool interrupted = false;
  bool written = false;      ///< the result file is complete
  std::vector<int> refused;  ///< cells that gave an error instead of figures
  Diagnostics refusals;      ///< the first of these errors
  bool died = false;         ///< a worker process died
};

/// Runs the unfinished cells and writes the result file when all cells are finished. The file's
/// bytes do not depend on which process ran which cell. Call it before any thread is started.
[[nodiscard]] Expected<SweepOutcome> runSweep(const SweepGrid& grid, const SweepPlan& plan);

/// Table of a map: mean of a figure over all axes except two.
[[nodiscard]] std::vector<std::vector<double>> mapOf(const SweepGrid& grid, const SweepMap& map,
                                                     const std::vector<double>& figure);

}  // namespace wholehand
