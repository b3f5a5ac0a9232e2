#pragma once

#include "rig/run/run.hpp"
#include "support/rig_tools.hpp"

#include <cstdint>
#include <string>
#include <utility>

namespace wholehand::test {

/// Records `ticks` ticks of a rig as fast as they are computed. @return the file's path
inline std::string recordTicks(Rig& rig, std::uint64_t ticks, const std::string& file) {
  RunPlan plan;
  plan.simulated_clock = true;
  plan.duration_ticks = ticks;
  plan.record = file;
  orThrow(runAndRecord(rig, plan));
  return plan.record;
}

/// Records a tenth of a second of a resting hand.
inline std::string recordRest(Models models, const std::string& file) {
  const auto rig = orThrow(buildRig(
      std::move(models), Intention::throughWaypoints({{0.0, AxisPosition(6)}}), RigOptions{}));
  return recordTicks(*rig, 100, file);
}

}  // namespace wholehand::test
