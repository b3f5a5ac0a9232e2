#pragma once

#include "experiments/sweep/cell_values.hpp"
#include "experiments/sweep/grid.hpp"
#include "loop/core/expected.hpp"

#include <string>

namespace wholehand {

/// Finds files by the names of a grid: a path that ends in .toml stands beside the grid, any other
/// name is that of a shipped file.
[[nodiscard]] FindFile filesBeside(const std::string& grid);

/// "80 cells (2 patient × 40 stiffness)"
[[nodiscard]] std::string summaryOf(const SweepGrid& grid);

/// Faults of the files that cells of a grid read, each once. Every two axes that name files are
/// combined, while the other axes keep their first value.
[[nodiscard]] Diagnostics faultsOfCells(const SweepGrid& grid, const FindFile& find);

/// The summary of a grid file. Refused: a faulty grid, and one whose cells read a file that is
/// missing or do not load (faultsOfCells()).
[[nodiscard]] Expected<std::string> summarizeSweep(const std::string& path);

}  // namespace wholehand
