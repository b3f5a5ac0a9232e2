#pragma once

#include "safety/force_limiter.hpp"

namespace wholehand {

/// Holds the power that all axes together give to `limit_w`: no axis may give more than a share p̂,
/// the largest with which Σ min(pᵢ, p̂) is the limit; what pushes along the motion is scaled down to
/// it, what brakes it stays (Fault::kPowerLimit, information). Continuous, and an axis that hardly
/// moves keeps its effort, whatever the noise of its velocity. The
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
