#include "apps/wholehand/shared/sweep_files.hpp"

#include "apps/wholehand/shared/shipped_files.hpp"

#include <fmt/format.h>

#include <filesystem>

namespace wholehand {
namespace fs = std::filesystem;

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
  return summaryOf(*grid);
}

}  // namespace wholehand
