#pragma once

#include "device/conformance/check.hpp"
#include "device/plugin/plugin_driver.hpp"

#include <string>
#include <vector>

namespace wholehand {

struct ConformanceOptions {
  DriverLocation driver;
  std::string only;                 ///< ids that begin with this; empty: all
  bool allow_effort = false;        ///< nobody is attached: Does::kMoves may run
  bool allow_beyond_limit = false;  ///< Does::kOverreaches may, too
  double longest_check_s = 15.0;    ///< a check that takes longer hangs
};

struct CheckResult {
  const Check* check = nullptr;
  CheckFinding finding;
};

/// Holds a driver against device.h, every check of every group. Each group runs in a process of its
/// own, forked from this one: a driver that crashes, hangs or ends the process fails the check that
/// was under way, and the rest of its group is not run.
/// @pre this process has one thread. Not real-time safe.
[[nodiscard]] std::vector<CheckResult> conform(const ConformanceOptions& options);

}  // namespace wholehand
