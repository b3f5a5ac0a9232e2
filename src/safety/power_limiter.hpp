#pragma once

#include "safety/force_limiter.hpp"

namespace wholehand {

/// Holds the power that all axes together give to `limit_w`: the efforts that push along the motion
/// are scaled down by one factor; those that brake it stay (Fault::kPowerLimit, information). The
/// device's own weight is not counted. The slew limit has the last word after it: a hand that
/// speeds up faster than an effort may fall is held to this power some ticks later. Pure, real-time
/// safe.
/// @param effort finite, as it would be sent @param neutral carries the device's weight
/// @param limit_w > 0
[[nodiscard]] WHOLEHAND_RT LimitedEffort limitPower(const AxisEffort& effort,
                                                    const AxisEffort& neutral,
                                                    const AxisVelocity& qd,
                                                    double limit_w) noexcept;

}  // namespace wholehand
