#pragma once

#include "device/conformance/bench.hpp"
#include "device/conformance/finding.hpp"

#include <span>

namespace wholehand {

/// What a check does to the device.
enum class Does {
  kLooks,       ///< nothing moves and nothing is enabled
  kMoves,       ///< enables it, sends up to kEffortShare of its limit: nobody may be attached
  kOverreaches  ///< asks for more than the limit for 5 ms, which the drive has to clip
};

/// One requirement of device.h.
struct Check {
  const char* id;      ///< "samples.sequence"
  const char* asks;    ///< one line: what must hold
  const char* remedy;  ///< what the driver's author does about it
  Does does;
  DriverStage before;  ///< how far the driver is brought before it
  CheckFinding (*look)(DriverBench&);
};

/// Checks that share one process and, from DriverStage::kOpen on, one device.
struct CheckGroup {
  const char* name;
  std::span<const Check> checks;
};

/// All groups, in the order in which they run. They are data; nothing is registered at run time.
[[nodiscard]] std::span<const CheckGroup> checkGroups();

// One table a file.
[[nodiscard]] std::span<const Check> boundaryChecks();
[[nodiscard]] std::span<const Check> descriptionChecks();
[[nodiscard]] std::span<const Check> lifecycleChecks();
[[nodiscard]] std::span<const Check> sampleChecks();
[[nodiscard]] std::span<const Check> commandChecks();
[[nodiscard]] std::span<const Check> timeChecks();
[[nodiscard]] std::span<const Check> watchdogChecks();
[[nodiscard]] std::span<const Check> faultChecks();

}  // namespace wholehand
