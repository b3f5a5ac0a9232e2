#pragma once

#include "experiments/sweep/sweep.hpp"
#include "loop/core/expected.hpp"

#include <optional>
#include <string>

namespace wholehand {

struct SweepOptions {
  std::string grid;
  std::string out;     ///< HDF5 file of the results
  std::string chart;   ///< HTML page of the maps; empty: none
  std::string share;   ///< "K/N": only the K-th of N shares; empty: all, or as the environment says
  bool array = false;  ///< the share that Slurm's job array gives this task
  int processes = 0;   ///< 0: one for each core; with a share one
};

/// A whole number of the environment; nothing where it is missing or no number.
[[nodiscard]] std::optional<int> environmentNumber(const char* name);
/// The share of a rank that mpirun started; nothing for a single program, and without the lab.
[[nodiscard]] std::optional<SweepShare> shareOfRank();

/// Runs every cell of a grid (docs/sweeps.md). Returns the exit code.
int sweepCommand(const SweepOptions& options);

/// "80 cells (2 patient × 40 stiffness)". Refused: a faulty grid, and one whose cells read a file
/// that is missing.
[[nodiscard]] Expected<std::string> summarizeSweep(const std::string& path);

}  // namespace wholehand
