#pragma once

#include "experiments/sweep/sweep.hpp"

#include <optional>
#include <string>

namespace wholehand {

struct SweepOptions {
  std::string grid;
  std::string out;     ///< HDF5 file of the results
  std::string chart;   ///< HTML page of the maps; empty: none
  std::string share;   ///< "K/N": only the K-th of N shares; empty: all, or the share that the
                       ///< environment names
  bool array = false;  ///< take the share of this task in Slurm's job array
  int processes = 0;   ///< 0: one per core; one if a share is given
};

/// A whole number in the environment; empty when it is missing or not a number.
[[nodiscard]] std::optional<int> environmentNumber(const char* name);
/// Share of a rank that mpirun started; empty for a single program, and without the lab.
[[nodiscard]] std::optional<SweepShare> shareOfRank();

/// Runs every cell of a grid (docs/sweeps.md). Returns the exit code.
int sweepCommand(const SweepOptions& options);

}  // namespace wholehand
