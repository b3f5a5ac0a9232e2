#include "experiments/sweep/cell_values.hpp"

#include <algorithm>

namespace wholehand {

ModelFiles filesFor(const SweepGrid& grid, const CellValues& values, const FindFile& find) {
  ModelFiles files;
  files.scene = find("scenes", "four-shapes");
  files.hand = find("hands", values.text("hand", "adult-median-right"));
  const std::string device = values.text("device", "lambda-pride");
  files.device = find("devices", device);
  files.rendering = find("rendering", values.text("rendering", device));
  files.patient = find("patients", values.text("patient", "relaxed-adult"));
  if (grid.trial == SweepTrial::kPlay) {
    files.exercise = find("exercises", values.text("exercise", "cocktail-bar"));
    files.level = static_cast<int>(values.number("level", 1));
  }
  return files;
}

std::vector<std::string> filesOf(const SweepGrid& grid, const FindFile& find) {
  std::vector<std::string> files;
  // Each axis is varied alone, because a file depends on one axis only (the gains depend on the
  // device's axis).
  for (std::size_t axis = 0; axis < grid.axes.size(); ++axis) {
    std::vector<int> places(grid.axes.size(), 0);
    for (places[axis] = 0; places[axis] < grid.axes[axis].size(); ++places[axis]) {
      for (const std::string& file : filesFor(grid, CellValues(grid, places), find).all()) {
        if (!file.empty()) files.push_back(file);
      }
    }
  }
  std::sort(files.begin(), files.end());
  files.erase(std::unique(files.begin(), files.end()), files.end());
  return files;
}

}  // namespace wholehand
