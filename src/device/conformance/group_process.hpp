#pragma once

#include "device/conformance/check.hpp"

#include <vector>

namespace wholehand {

/// Runs checks in a child process, in order, and returns a finding for each. If the child dies or a
/// check exceeds `longest_check_s`, the current check fails and the rest is not run. Processes that
/// the driver leaves behind are killed.
[[nodiscard]] std::vector<CheckFinding> runInProcess(const DriverLocation& driver,
                                                     const std::vector<KnownAxis>& known,
                                                     const std::vector<const Check*>& checks,
                                                     double longest_check_s);

}  // namespace wholehand
