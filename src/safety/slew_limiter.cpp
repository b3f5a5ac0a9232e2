#include "safety/slew_limiter.hpp"

#include <algorithm>

namespace wholehand {

LimitedEffort limitSlew(const AxisEffort& effort, const AxisEffort& last,
                        const AxisEffort& most_change) noexcept {
  LimitedEffort out{effort};
  for (int i = 0; i < effort.size(); ++i) {
    out.effort[i] = std::clamp(effort[i], last[i] - most_change[i], last[i] + most_change[i]);
    if (out.effort[i] == effort[i]) continue;
    out.faults = Fault::kEffortSlew;
    if (out.axis < 0) out.axis = i;
  }
  return out;
}

}  // namespace wholehand
