#include "safety/power_limiter.hpp"

namespace wholehand {

LimitedEffort limitPower(const AxisEffort& effort, const AxisEffort& neutral,
                         const AxisVelocity& qd, double limit_w) noexcept {
  LimitedEffort out{effort};
  double given_w = 0.0;
  for (int i = 0; i < effort.size(); ++i) {
    const double power_w = (effort[i] - neutral[i]) * qd[i];
    if (power_w > 0.0) given_w += power_w;
  }
  if (!(given_w > limit_w)) return out;
  const double share = limit_w / given_w;
  for (int i = 0; i < effort.size(); ++i) {
    const double pushed = effort[i] - neutral[i];
    if (pushed * qd[i] > 0.0) out.effort[i] = neutral[i] + share * pushed;
  }
  out.faults = Fault::kPowerLimit;
  return out;
}

}  // namespace wholehand
