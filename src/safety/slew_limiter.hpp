#pragma once

#include "safety/force_limiter.hpp"

namespace wholehand {

/// Holds every effort within ± most_change of the last one sent (Fault::kEffortSlew, information):
/// the last thing before the device, so that nothing whatever makes a step, not a longer one after
/// a stall either. Pure, real-time safe.
/// @param effort finite @param most_change > 0 in one period
[[nodiscard]] WHOLEHAND_RT LimitedEffort limitSlew(const AxisEffort& effort, const AxisEffort& last,
                                                   const AxisEffort& most_change) noexcept;

}  // namespace wholehand
