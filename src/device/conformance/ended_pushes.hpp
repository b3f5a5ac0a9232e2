#pragma once

#include "device/conformance/check.hpp"

namespace wholehand {

// Checks of the group "motion"; each is told of in its table (motion_checks.cpp).
[[nodiscard]] CheckFinding pushReleased(DriverBench& bench);
[[nodiscard]] CheckFinding pushSilenced(DriverBench& bench);
[[nodiscard]] CheckFinding pushDisabled(DriverBench& bench);
[[nodiscard]] CheckFinding pushClosed(DriverBench& bench);
[[nodiscard]] CheckFinding stillAtNeutral(DriverBench& bench);
[[nodiscard]] CheckFinding stillEnabledAgain(DriverBench& bench);
[[nodiscard]] CheckFinding pushLimited(DriverBench& bench);

}  // namespace wholehand
