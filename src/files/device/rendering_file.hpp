#pragma once

#include "loop/core/expected.hpp"
#include "loop/model/device_model.hpp"
#include "loop/model/rendering_config.hpp"

#include <string>

namespace wholehand {

/// Reads a rendering file for a device: every axis of the device must have gains, and no other axis
/// may. Tip values are multiplied by the device's lever arm; `paper = true` sets γ and f_d.
[[nodiscard]] Expected<RenderingConfig> loadRenderingFile(const std::string& path,
                                                          const DeviceModel& device);

}  // namespace wholehand
