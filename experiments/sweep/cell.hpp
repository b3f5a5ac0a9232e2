#pragma once

#include "experiments/sweep/grid.hpp"

#include <functional>
#include <string>
#include <vector>

namespace wholehand {

/// Finds a file by its folder and name in a grid: "hands", "man-p05-right" gives the path of the
/// shipped hand of that name.
using FindFile = std::function<std::string(const std::string& folder, const std::string& name)>;

/// Runs one cell on the simulated clock. The result is bit-identical in every process.
/// @param scratch folder for scene files that no other process uses at the same time
/// @return the figures, in the order of figuresOf(); an error names the cell
[[nodiscard]] Expected<std::vector<double>> runCell(const SweepGrid& grid, int cell,
                                                    const FindFile& find,
                                                    const std::string& scratch);

/// Paths of all files that the cells read, sorted.
[[nodiscard]] std::vector<std::string> filesOf(const SweepGrid& grid, const FindFile& find);

}  // namespace wholehand
