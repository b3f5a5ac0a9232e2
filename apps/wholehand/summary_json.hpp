#pragma once

#include "assembly/recorded_run.hpp"
#include "model/device_model.hpp"

#include <nlohmann/json.hpp>

namespace wholehand {

/// {"p50":..,"p99":..,"p999":..,"max":..} in microseconds.
[[nodiscard]] nlohmann::ordered_json microseconds(const Percentiles& p);

/// What `run --json` writes; efforts in the axis's unit.
[[nodiscard]] nlohmann::ordered_json summaryJson(const DeviceModel& device,
                                                 const RunOutcome& outcome);

}  // namespace wholehand
