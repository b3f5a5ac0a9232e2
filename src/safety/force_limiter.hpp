#pragma once

#include "core/axis_array.hpp"
#include "core/fault.hpp"
#include "core/real_time.hpp"

namespace wholehand {

/// A limited effort and the limits that acted.
struct LimitedEffort {
  AxisEffort effort;  ///< every element finite and within ± limit
  Fault faults = Fault::kNone;
  int axis = -1;  ///< first axis that was limited; -1: no particular axis
};

/// Clamps every effort to ± limit (Fault::kEffortLimit, information). NaN and infinity become 0 and
/// report Fault::kNonFiniteEffort, which stops rendering. A limit that is NaN or ≤ 0 gives 0. The
/// result has the size of `limit`; a missing effort is 0. Pure, real-time safe.
[[nodiscard]] WHOLEHAND_RT LimitedEffort limitEffort(const AxisEffort& effort,
                                                     const AxisEffort& limit) noexcept;

/// Limits the power that all axes together deliver to `limit_w`. No axis may deliver more than p̂,
/// the largest power with which Σ min(pᵢ, p̂) is the limit. Efforts along the motion are scaled
/// down to p̂; braking efforts stay (Fault::kPowerLimit, information). Continuous; an axis that
/// hardly moves keeps its effort, whatever its velocity noise. The device's own weight is not
/// counted. The slew limit acts after this one: when a hand accelerates faster than the effort may
/// fall, the power limit is met some ticks later. Pure, real-time safe.
/// @param effort finite, as it would be sent @param neutral carries the device's weight
/// @param limit_w > 0
[[nodiscard]] WHOLEHAND_RT LimitedEffort limitPower(const AxisEffort& effort,
                                                    const AxisEffort& neutral,
                                                    const AxisVelocity& qd,
                                                    double limit_w) noexcept;

}  // namespace wholehand
