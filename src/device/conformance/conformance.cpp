#include "device/conformance/conformance.hpp"

#include "device/conformance/group_process.hpp"

#include <array>

namespace wholehand {
namespace {

// Why a check is left out; empty: it runs.
std::string whyLeftOut(const Check& check, const ConformanceOptions& options) {
  if (check.effect == Effect::kLooks) return {};
  if (!options.allow_effort) return "moves the device: --allow-effort, with nobody attached";
  if (check.effect == Effect::kOverreaches && !options.allow_beyond_limit) {
    return "asks for more than the limit: --allow-beyond-limit, with the device held or free";
  }
  return {};
}

bool isAskedFor(const Check& check, const std::string& only) {
  return std::string(check.id).compare(0, only.size(), only) == 0;
}

}  // namespace

std::span<const CheckGroup> checkGroups() {
  static const std::array<CheckGroup, 9> kGroups = {{{"boundary", boundaryChecks()},
                                                     {"description", descriptionChecks()},
                                                     {"lifecycle", lifecycleChecks()},
                                                     {"samples", sampleChecks()},
                                                     {"commands", commandChecks()},
                                                     {"motion", motionChecks()},
                                                     {"time", timeChecks()},
                                                     {"watchdog", watchdogChecks()},
                                                     {"faults", faultChecks()}}};
  return kGroups;
}

std::vector<CheckResult> conform(const ConformanceOptions& options) {
  std::vector<CheckResult> out;
  for (const CheckGroup& group : checkGroups()) {
    std::vector<CheckResult> results;
    std::vector<std::size_t> to_run;
    for (const Check& check : group.checks) {
      if (!isAskedFor(check, options.only)) continue;
      const std::string left_out = whyLeftOut(check, options);
      if (left_out.empty()) to_run.push_back(results.size());
      results.push_back({&check, skipped(left_out)});
    }
    std::vector<const Check*> checks;
    for (const std::size_t i : to_run) checks.push_back(results[i].check);
    if (checks.empty()) {
      out.insert(out.end(), results.begin(), results.end());
      continue;
    }
    const std::vector<CheckFinding> findings =
        runInProcess(options.driver, options.known, checks, options.longest_check_s);
    for (std::size_t i = 0; i < to_run.size(); ++i) results[to_run[i]].finding = findings[i];
    out.insert(out.end(), results.begin(), results.end());
  }
  return out;
}

}  // namespace wholehand
