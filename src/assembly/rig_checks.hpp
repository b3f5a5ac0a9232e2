#pragma once

#include "assembly/models.hpp"
#include "control/coupling_gains.hpp"

namespace wholehand {

// These checks are not only in the loaders, because a program may change its models after loading.

/// Refuses models larger than a tick has room for.
[[nodiscard]] Diagnostics refuseTooLarge(const Models& models);

/// Refuses a device whose limits are ineffective or cannot be kept: not a number, zero, a reversed
/// range, a neutral effort beyond the limit, or a slew limit too low to reach neutral in time.
[[nodiscard]] Diagnostics refuseImpossibleLimits(const DeviceModel& device);

/// Refuses a stated armature with which the avatar feels heavier in free motion than the device's
/// own moving mass.
[[nodiscard]] Diagnostics refuseHeavyArmature(const Models& models, const CouplingGains& gains,
                                              double period_s);

}  // namespace wholehand
