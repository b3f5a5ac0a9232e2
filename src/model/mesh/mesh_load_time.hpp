#pragma once

#include "core/expected.hpp"

#include <chrono>
#include <functional>
#include <string>
#include <utility>
#include <vector>

namespace wholehand {

/// Time that all meshes of one scene or URDF may take together. One file alone is limited to
/// kLongestMeshRead, too.
class MeshLoadTime {
 public:
  using Duration = std::chrono::milliseconds;
  using Clock = std::function<std::chrono::steady_clock::time_point()>;

  static constexpr Duration kTotal = std::chrono::seconds(30);

  explicit MeshLoadTime(Duration total = kTotal, Clock clock = std::chrono::steady_clock::now)
      : total_(total), clock_(std::move(clock)) {}

  /// Runs `load` and adds its time to that of the file.
  template <class Load>
  auto measure(const std::string& path, Load load) {
    const auto begin = clock_();
    auto result = load();
    add(path, std::chrono::duration_cast<Duration>(clock_() - begin));
    return result;
  }
  /// Time that is left, >= 0.
  [[nodiscard]] Duration left() const;
  [[nodiscard]] bool isOver() const { return !files_.empty() && taken_ >= total_; }
  /// Problem and remedy once the time is over: which files took how long, the slowest first.
  [[nodiscard]] Diagnostic fault() const;

 private:
  void add(const std::string& path, Duration taken);

  Duration total_;
  Clock clock_;
  Duration taken_{0};
  std::vector<std::pair<std::string, Duration>> files_;
};

}  // namespace wholehand
