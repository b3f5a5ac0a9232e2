#pragma once

#include "loop/core/expected.hpp"
#include "loop/model/device_model.hpp"

#include <string>

namespace wholehand {

/// Reads and checks a device file. Values given at the tip (keys ending in _tip_n) are multiplied
/// by the axis's lever arm here, once.
[[nodiscard]] Expected<DeviceModel> loadDeviceFile(const std::string& path);

}  // namespace wholehand
