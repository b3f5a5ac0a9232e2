#pragma once

#include "assembly/models.hpp"

namespace wholehand {

// Here, not in the loaders alone: a program may change its models after they were loaded.

/// Models that are larger than what a tick has room for.
[[nodiscard]] Diagnostics refuseTooLarge(const Models& models);

/// A device whose limits hold nothing or cannot be kept: no number, zero, a range the wrong way
/// round, a neutral effort beyond the limit, or a slew limit too low to reach neutral in time.
[[nodiscard]] Diagnostics refuseImpossibleLimits(const DeviceModel& device);

}  // namespace wholehand
