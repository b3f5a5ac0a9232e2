#pragma once

#include "assembly/models.hpp"
#include "control/coupling_gains.hpp"

namespace wholehand {

// Here, not in the loaders alone: a program may change its models after they were loaded.

/// Models that are larger than what a tick has room for.
[[nodiscard]] Diagnostics refuseTooLarge(const Models& models);

/// A device whose limits hold nothing or cannot be kept: no number, zero, a range the wrong way
/// round, a neutral effort beyond the limit, or a slew limit too low to reach neutral in time.
[[nodiscard]] Diagnostics refuseImpossibleLimits(const DeviceModel& device);

/// An armature that a rendering file states and with which the avatar is felt, in free motion, as
/// more than the device's own moving mass: a weight in the hand.
[[nodiscard]] Diagnostics refuseHeavyArmature(const Models& models, const CouplingGains& gains,
                                              double period_s);

}  // namespace wholehand
