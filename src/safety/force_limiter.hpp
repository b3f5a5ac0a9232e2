#pragma once

#include "core/axis_array.hpp"
#include "core/fault.hpp"
#include "core/real_time.hpp"

namespace wholehand {

/// An effort that may be sent, and what had to be done to it.
struct LimitedEffort {
  AxisEffort effort;  ///< every element finite and within ± limit
  Fault faults = Fault::kNone;
  int axis = -1;  ///< the first one that was limited; -1: none in particular
};

/// Clamps every effort to ± limit (Fault::kEffortLimit, information). NaN and infinity become 0 and
/// report Fault::kNonFiniteEffort, which stops rendering. A limit that is no number > 0 lets
/// nothing through. The result has the size of `limit`; a missing effort is 0. Pure, real-time
/// safe.
[[nodiscard]] WHOLEHAND_RT LimitedEffort limitEffort(const AxisEffort& effort,
                                                     const AxisEffort& limit) noexcept;

}  // namespace wholehand
