#pragma once

#include "assembly/rehearsal.hpp"
#include "assembly/run.hpp"
#include "assembly/safety_log.hpp"
#include "model/device_model.hpp"

#include <nlohmann/json.hpp>

#include <optional>
#include <vector>

namespace wholehand {

/// {"p50":..,"p99":..,"p999":..,"max":..} in microseconds.
[[nodiscard]] nlohmann::ordered_json microseconds(const Percentiles& p);

/// Safety events of a run.
struct RunSafety {
  std::vector<SafetyTransition> transitions;
  std::optional<Rehearsal> rehearsal;  ///< none on the simulated clock
};

/// JSON of `run --json`; efforts in the axis's unit.
[[nodiscard]] nlohmann::ordered_json summaryJson(const DeviceModel& device,
                                                 const RunOutcome& outcome,
                                                 const RunSafety& safety);

}  // namespace wholehand
