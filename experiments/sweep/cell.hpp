#pragma once

#include "experiments/sweep/cell_values.hpp"
#include "experiments/sweep/grid.hpp"

#include <functional>
#include <string>
#include <vector>

namespace wholehand {

/// Runs one cell on the simulated clock. The result is bit-identical in every process.
/// @param scratch folder for scene files that no other process uses at the same time
/// @return the figures, in the order of figuresOf(); an error names the cell
[[nodiscard]] Expected<std::vector<double>> runCell(const SweepGrid& grid, int cell,
                                                    const FindFile& find,
                                                    const std::string& scratch);

}  // namespace wholehand
