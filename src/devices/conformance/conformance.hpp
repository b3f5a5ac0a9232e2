#pragma once

#include "devices/conformance/bench.hpp"
#include "devices/plugin/plugin_driver.hpp"

#include <span>
#include <string>
#include <vector>

namespace wholehand {

/// Outcome of a check.
enum class Outcome {
  kPassed,
  kFailed,
  kSkipped  ///< not allowed or not possible; the finding says why
};

struct CheckFinding {
  Outcome outcome = Outcome::kSkipped;
  std::string text;  ///< observation; may be empty for a passed check
};

[[nodiscard]] inline CheckFinding passed(std::string text = {}) {
  return {Outcome::kPassed, std::move(text)};
}
[[nodiscard]] inline CheckFinding failed(std::string text) {
  return {Outcome::kFailed, std::move(text)};
}
[[nodiscard]] inline CheckFinding skipped(std::string text) {
  return {Outcome::kSkipped, std::move(text)};
}
/// Passed if `wrong` is empty, else failed with that text.
[[nodiscard]] inline CheckFinding unless(std::string violation) {
  return violation.empty() ? passed() : failed(std::move(violation));
}

/// Effect of a check on the device.
enum class Effect {
  kLooks,       ///< nothing moves or is enabled
  kMoves,       ///< enables the device and sends up to kEffortShare of its limit: no person may be
                ///< attached
  kOverreaches  ///< commands more than the limit for 5 ms, which the drive must clip
};

/// One requirement of device.h.
struct Check {
  const char* id;      ///< "samples.sequence"
  const char* asks;    ///< the requirement, one line
  const char* remedy;  ///< advice to the driver's author
  CheckFinding (*look)(DriverBench&);
  DriverStage before = DriverStage::kOpen;  ///< stage that the driver is brought to first
  Effect effect = before == DriverStage::kEnabled ? Effect::kMoves : Effect::kLooks;
};

/// Checks that share one process and, from DriverStage::kOpen on, one device.
struct CheckGroup {
  const char* name;
  std::span<const Check> checks;
};

/// All groups, in the order in which they run. Static data, no registration at run time.
[[nodiscard]] std::span<const CheckGroup> checkGroups();

// One table per file.
[[nodiscard]] std::span<const Check> boundaryChecks();
[[nodiscard]] std::span<const Check> descriptionChecks();
[[nodiscard]] std::span<const Check> lifecycleChecks();
[[nodiscard]] std::span<const Check> sampleChecks();
[[nodiscard]] std::span<const Check> commandChecks();
[[nodiscard]] std::span<const Check> motionChecks();
[[nodiscard]] std::span<const Check> timeChecks();
[[nodiscard]] std::span<const Check> watchdogChecks();
[[nodiscard]] std::span<const Check> faultChecks();

struct ConformanceOptions {
  DriverLocation driver;
  std::vector<KnownAxis> known;     ///< axes of the device file; empty: no file is given
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
/// its group is not run. Not real-time safe.
/// @pre this process has one thread
[[nodiscard]] std::vector<CheckResult> conform(const ConformanceOptions& options);

}  // namespace wholehand
