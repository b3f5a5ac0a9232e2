#pragma once

#include "experiments/sweep/grid.hpp"
#include "rig/models.hpp"

#include <functional>
#include <string>
#include <utility>
#include <vector>

namespace wholehand {

/// Finds a file by its folder and name in a grid: "hands", "man-p05-right" gives the path of the
/// shipped hand of that name.
using FindFile = std::function<std::string(const std::string& folder, const std::string& name)>;

/// The values of one cell by axis. Axes that the grid lacks have default values.
class CellValues {
 public:
  CellValues(const SweepGrid& grid, std::vector<int> places)
      : grid_(grid), places_(std::move(places)) {}

  [[nodiscard]] std::string text(const std::string& axis, const std::string& fallback) const {
    for (std::size_t i = 0; i < places_.size(); ++i) {
      if (grid_.axes[i].name == axis) return grid_.axes[i].names.at(places_[i]);
    }
    return fallback;
  }
  [[nodiscard]] double number(const std::string& axis, double fallback) const {
    for (std::size_t i = 0; i < places_.size(); ++i) {
      if (grid_.axes[i].name == axis) return grid_.axes[i].numbers.at(places_[i]);
    }
    return fallback;
  }

 private:
  const SweepGrid& grid_;
  std::vector<int> places_;
};

/// Files that one cell reads.
[[nodiscard]] ModelFiles filesFor(const SweepGrid& grid, const CellValues& values,
                                  const FindFile& find);

/// Paths of all files that the cells read, sorted.
[[nodiscard]] std::vector<std::string> filesOf(const SweepGrid& grid, const FindFile& find);

}  // namespace wholehand
