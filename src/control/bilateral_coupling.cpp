#include "control/bilateral_coupling.hpp"

namespace wholehand {

AxisEffort avatarEffort(const AxisPosition& q_m, const AxisVelocity& qd_mf, const AxisPosition& q_s,
                        const AxisVelocity& qd_s, const AxisDamping& avatar_damping,
                        const CouplingGains& gains) noexcept {
  AxisEffort f_s(gains.axes);
  for (int i = 0; i < gains.axes; ++i) {
    f_s[i] = gains.k_pm[i] * (q_m[i] - q_s[i]) + avatar_damping[i] * (qd_mf[i] - qd_s[i]);
  }
  return f_s;
}

AxisEffort couplingEffort(const AxisPosition& q_m, const AxisVelocity& qd_mf,
                          const AxisPosition& q_s, const AxisVelocity& qd_s,
                          const AxisDamping& avatar_damping, const CouplingGains& gains) noexcept {
  AxisEffort f(gains.axes);
  for (int i = 0; i < gains.axes; ++i) {
    f[i] = gains.k_pm[i] * (q_s[i] - q_m[i]) +
           gains.gamma[i] * avatar_damping[i] * (qd_s[i] - qd_mf[i]);
  }
  return f;
}

}  // namespace wholehand
