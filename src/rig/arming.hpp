#pragma once

#include "loop/device/haptic_device.hpp"
#include "rig/models.hpp"
#include "rig/rig.hpp"

namespace wholehand {

/// The options with the delay that the device measured at arming (DelayedDevice) in every corner of
/// the passport. Unchanged without a passport, or if no corner states less.
[[nodiscard]] RigOptions withDelayOf(const HapticDevice& device, RigOptions options);

/// Name, within a recording, of the file that says which delay the corners of its passport had:
/// the kind `arming-delay` with `periods`.
inline constexpr const char* kRecordedDelay = "passport/delay.toml";

/// The gains, and the reasons why they may not be rendered with this device. A delay that is longer
/// than the passport's refuses them only if they are not certified with it; the error then names
/// both delays.
[[nodiscard]] Expected<CheckedGains> checkGainsAtArming(const Models& models,
                                                        const HapticDevice& device,
                                                        const RigOptions& options);

}  // namespace wholehand
