#pragma once

#include "device/conformance/check.hpp"

#include <vector>

namespace wholehand {

/// Carries out checks in a child process, in their order, and returns a finding for each. When the
/// child dies or a check takes longer than `longest_check_s`, that is the finding of the check that
/// was under way, and the ones after it are not run. What the driver leaves behind is ended.
[[nodiscard]] std::vector<CheckFinding> runInProcess(const DriverLocation& driver,
                                                     const std::vector<const Check*>& checks,
                                                     double longest_check_s);

}  // namespace wholehand
