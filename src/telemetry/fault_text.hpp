#pragma once

#include "core/fault.hpp"
#include "model/device_model.hpp"
#include "telemetry/statistics.hpp"

#include <string>
#include <vector>

namespace wholehand {

/// Text of what stopped a run: "device read failed in 1 tick"; "none".
/// @param axes names of the device's axes, for faults of an axis
[[nodiscard]] std::string faultText(const TickSummary& summary,
                                    const std::vector<DeviceAxis>& axes = {});
/// Text of what was limited or noticed without stopping: "effort limited in 12 ticks (x 10,
/// finger_flexion 2)"; "none".
[[nodiscard]] std::string noticeText(const TickSummary& summary,
                                     const std::vector<DeviceAxis>& axes = {});

}  // namespace wholehand
