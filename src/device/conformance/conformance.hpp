#pragma once

#include "device/conformance/check.hpp"
#include "device/plugin/plugin_driver.hpp"

#include <string>
#include <vector>

namespace wholehand {

struct ConformanceOptions {
  DriverLocation driver;
  std::vector<KnownAxis> known;     ///< of the device file; empty: none is given
  std::string only;                 ///< only checks whose id begins with this; empty: all
  bool allow_effort = false;        ///< nobody is attached: allows Effect::kMoves
  bool allow_beyond_limit = false;  ///< also allows Effect::kOverreaches
  double longest_check_s = 15.0;    ///< timeout of a check
};

struct CheckResult {
  const Check* check = nullptr;
  CheckFinding finding;
};

/// Runs every check of device.h against a driver. Each group runs in its own process, forked from
/// this one. A driver that crashes, hangs or ends the process fails the current check; the rest of
/// its group is not run.
/// @pre this process has one thread. Not real-time safe.
[[nodiscard]] std::vector<CheckResult> conform(const ConformanceOptions& options);

}  // namespace wholehand
