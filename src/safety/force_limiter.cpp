#include "safety/force_limiter.hpp"

#include <algorithm>
#include <cmath>

namespace wholehand {

LimitedEffort limitEffort(const AxisEffort& effort, const AxisEffort& limit) noexcept {
  LimitedEffort out{AxisEffort(limit.size()), Fault::kNone};
  const int n = std::min(effort.size(), limit.size());
  for (int i = 0; i < n; ++i) {
    if (!std::isfinite(effort[i])) {
      if (!any(out.faults & Fault::kNonFiniteEffort)) out.axis = i;  // overrides a limit
      out.faults |= Fault::kNonFiniteEffort;
      continue;
    }
    const double bound = limit[i] > 0.0 ? limit[i] : 0.0;  // NaN: limit 0
    out.effort[i] = std::clamp(effort[i], -bound, bound);
    if (out.effort[i] == effort[i]) continue;
    out.faults |= Fault::kEffortLimit;
    if (out.axis < 0) out.axis = i;
  }
  return out;
}

}  // namespace wholehand
