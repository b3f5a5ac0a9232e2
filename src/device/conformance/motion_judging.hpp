#pragma once

#include "device/conformance/check.hpp"
#include "device/conformance/pushes.hpp"

#include <cmath>
#include <string>
#include <vector>

/// What the checks by motion share: words for a person, and who is judged.
namespace wholehand {

/// Measurements that must agree before a check fails.
inline constexpr int kMotionAttempts = 2;

[[nodiscard]] inline std::string nameOf(const DriverBench& bench, std::size_t a) {
  return bench.axes()[a].name;
}

[[nodiscard]] inline const char* unit(const wh_axis& axis) {
  return axis.kind == WH_ROTATION ? " N·m" : " N";
}

[[nodiscard]] inline std::string effort(const DriverBench& bench, std::size_t a, double share) {
  const wh_axis& axis = bench.axes()[a];
  return number(share * axis.effort_limit) + unit(axis);
}

[[nodiscard]] inline std::string ms(double seconds) {
  return number(std::round(seconds * 1e4) * 0.1) + " ms";
}

[[nodiscard]] inline std::string percent(double share) {
  return number(std::round(100.0 * share)) + " %";
}

/// Why no axis, or not every one, is judged; empty: all are.
[[nodiscard]] inline std::string whyNotAll(const DriverBench& bench,
                                           const std::vector<PushedAxis>& axes) {
  std::string late, still;
  for (std::size_t a = 0; a < axes.size(); ++a) {
    if (!axes[a].asked || (axes[a].moved && !axes[a].late)) continue;
    std::string& names = axes[a].late ? late : still;
    names += (names.empty() ? "" : ", ") + nameOf(bench, a);
  }
  if (!late.empty()) return late + ": this machine stood still meanwhile";
  return still.empty() ? still : still + ": does not move (motion.moves)";
}

/// Judges every axis that takes efforts and moved, by one measurement; where it fails a second one
/// must agree. All that fail are named.
template <class Wrong>
[[nodiscard]] CheckFinding eachMoved(DriverBench& bench, Wrong wrong) {
  CheckFinding out;
  for (int attempt = 0; attempt < kMotionAttempts; ++attempt) {
    std::string failures;
    const std::vector<PushedAxis>& axes = bench.pushed();
    for (std::size_t a = 0; a < axes.size(); ++a) {
      if (!axes[a].asked || !axes[a].moved || axes[a].late) continue;
      const std::string text = wrong(axes[a], a);
      if (!text.empty()) failures += (failures.empty() ? "" : "; ") + nameOf(bench, a) + " " + text;
    }
    bench.forgetStalls();
    if (failures.empty()) {
      const std::string why = whyNotAll(bench, axes);
      if (why.empty()) return passed();
      return attempt > 0 ? out : skipped(why);  // what failed may keep it from being pushed again
    }
    out = failed(failures);
    if (attempt + 1 == kMotionAttempts || !bench.reach(DriverStage::kEnabled).empty()) break;
    bench.pushAnew();
  }
  return out;
}

}  // namespace wholehand
