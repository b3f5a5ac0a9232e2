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

}  // namespace wholehand
