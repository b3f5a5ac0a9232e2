#include "apps/wholehand/shared/sweep_files.hpp"

#include "apps/wholehand/shared/shipped_files.hpp"
#include "experiments/bar_figures.hpp"
#include "rig/models.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cstddef>
#include <filesystem>
#include <set>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace wholehand {
namespace fs = std::filesystem;
namespace {

/// Loads the files of cells, and keeps their faults, each once.
class CellFiles {
 public:
  CellFiles(const SweepGrid& grid, FindFile find) : grid_(grid), find_(std::move(find)) {}

  void load(const std::vector<int>& places) {
    const ModelFiles files = filesFor(grid_, CellValues(grid_, places), find_);
    std::vector<std::string> read = files.all();
    read.push_back(std::to_string(files.level));
    if (!loaded_.insert(std::move(read)).second) return;
    const auto models = loadModels(files);
    if (!models) {
      for (const Diagnostic& fault : models.errors()) add(fault);
    } else if (grid_.trial == SweepTrial::kPlay &&
               !BarFigures(models->exercise->description()).known()) {
      add(fileFault(files.exercise, "is not an exercise that a virtual patient can win",
                    "give the file of a cocktail bar"));
    }
  }

  [[nodiscard]] const Diagnostics& faults() const { return faults_; }

 private:
  void add(const Diagnostic& fault) {
    if (said_.insert(format(fault)).second) faults_.push_back(fault);
  }

  const SweepGrid& grid_;
  FindFile find_;
  std::set<std::vector<std::string>> loaded_;
  std::set<std::string> said_;
  Diagnostics faults_;
};

bool namesFiles(const SweepAxis& axis) {
  constexpr std::array<std::string_view, 6> kAxes = {"hand",    "device",   "rendering",
                                                     "patient", "exercise", "level"};
  return std::find(kAxes.begin(), kAxes.end(), axis.name) != kAxes.end();
}

}  // namespace

FindFile filesBeside(const std::string& grid) {
  return [folder = fs::path(grid).parent_path()](const std::string& kind, const std::string& name) {
    if (fs::path(name).extension() == ".toml") return (folder / name).string();
    return shippedFile("config/" + kind + "/" + name + ".toml");
  };
}

std::string summaryOf(const SweepGrid& grid) {
  std::string axes;
  for (const SweepAxis& axis : grid.axes) {
    axes += fmt::format("{}{} {}", axes.empty() ? "" : " × ", axis.size(), axis.name);
  }
  return fmt::format("{} cells ({})", grid.cells(), axes);
}

Diagnostics faultsOfCells(const SweepGrid& grid, const FindFile& find) {
  CellFiles files(grid, find);
  const std::size_t count = grid.axes.size();
  std::vector<int> places(count, 0);
  files.load(places);
  if (!files.faults().empty()) return files.faults();  // the others would repeat them
  for (std::size_t a = 0; a < count; ++a) {
    for (std::size_t b = a; b < count; ++b) {
      if (!namesFiles(grid.axes[a]) || !namesFiles(grid.axes[b])) continue;
      for (places[a] = 0; places[a] < grid.axes[a].size(); ++places[a]) {
        for (int at = 0; at < grid.axes[b].size(); ++at) {
          if (a != b) places[b] = at;
          files.load(places);
        }
      }
      places[a] = places[b] = 0;
    }
  }
  return files.faults();
}

Expected<std::string> summarizeSweep(const std::string& path) {
  auto grid = loadSweepGrid(path);
  if (!grid) return grid.errors();
  Diagnostics missing;
  std::error_code ignored;
  for (const std::string& file : filesOf(*grid, filesBeside(path))) {
    if (fs::exists(file, ignored)) continue;
    missing.push_back(keyFault(path, "axes", file, "is not there",
                               "name a shipped file, or a path ending in .toml beside the grid"));
  }
  if (!missing.empty()) return missing;
  if (Diagnostics faults = faultsOfCells(*grid, filesBeside(path)); !faults.empty()) return faults;
  return summaryOf(*grid);
}

}  // namespace wholehand
