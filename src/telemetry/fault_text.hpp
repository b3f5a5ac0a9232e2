#pragma once

#include "core/fault.hpp"
#include "model/device_model.hpp"
#include "telemetry/statistics.hpp"

#include <string>
#include <vector>

namespace wholehand {

/// What stopped a run, in words: "device read failed in 1 tick"; "none".
/// @param axes the device's: a fault of an axis then names it
[[nodiscard]] std::string faultText(const TickSummary& summary,
                                    const std::vector<DeviceAxis>& axes = {});
/// What was noticed and stopped nothing: "effort limited in 12 ticks (x 10, finger_flexion 2)";
/// "none".
[[nodiscard]] std::string noticeText(const TickSummary& summary,
                                     const std::vector<DeviceAxis>& axes = {});

}  // namespace wholehand
