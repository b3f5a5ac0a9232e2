#include "model/mesh/mesh_load_time.hpp"

#include "core/printable.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cstddef>
#include <filesystem>

namespace wholehand {
namespace {

double seconds(MeshLoadTime::Duration duration) {
  return std::chrono::duration<double>(duration).count();
}

}  // namespace

MeshLoadTime::Duration MeshLoadTime::left() const {
  return std::max(total_ - taken_, Duration::zero());
}

void MeshLoadTime::add(const std::string& path, Duration taken) {
  taken_ += taken;
  files_.emplace_back(path, taken);
}

Diagnostic MeshLoadTime::fault() const {
  constexpr std::size_t kNamed = 3;
  auto slowest = files_;
  std::stable_sort(slowest.begin(), slowest.end(),
                   [](const auto& a, const auto& b) { return a.second > b.second; });
  std::string files;
  Duration others{0};
  for (std::size_t i = 0; i < slowest.size(); ++i) {
    const auto& [path, taken] = slowest[i];
    if (i >= kNamed) {
      others += taken;
      continue;
    }
    files +=
        fmt::format("{}{} {:.1f} s", i == 0 ? "" : ", ",
                    printable(std::filesystem::path(path).filename().string()), seconds(taken));
  }
  if (slowest.size() > kNamed) {
    files += fmt::format(", {} more {:.1f} s", slowest.size() - kNamed, seconds(others));
  }
  return {"",
          0,
          "",
          "",
          fmt::format("the meshes up to this one took longer than {:g} s to load ({})",
                      seconds(total_), files),
          "simplify the meshes that took longest, or name fewer meshes"};
}

}  // namespace wholehand
