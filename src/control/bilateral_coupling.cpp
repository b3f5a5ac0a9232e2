#include "control/bilateral_coupling.hpp"

#include <algorithm>

namespace wholehand {

AxisMatrix driveInertia(const AxisMatrix& reduced_inertia, const AxisMatrix& inverse) noexcept {
  constexpr double kMostOfFree = 6.5;
  AxisMatrix drive = AxisMatrix::Zero(reduced_inertia.rows(), reduced_inertia.cols());
  for (Eigen::Index i = 0; i < drive.rows(); ++i) {
    drive(i, i) = std::min(reduced_inertia(i, i), kMostOfFree / inverse(i, i));
  }
  return drive;
}

AxisEffort avatarEffort(const AxisPosition& q_m, const AxisVelocity& qd_mf, const AxisPosition& q_s,
                        const AxisVelocity& qd_s, const AxisMatrix& drive_inertia,
                        const CouplingGains& gains) noexcept {
  AxisEffort f_s(gains.axes);
  for (int i = 0; i < gains.axes; ++i) {
    const double acceleration =
        gains.k_ps_per_s2[i] * (q_m[i] - q_s[i]) + gains.k_ds_per_s[i] * (qd_mf[i] - qd_s[i]);
    f_s[i] = drive_inertia(i, i) * acceleration;
  }
  return f_s;
}

AxisEffort couplingEffort(const AxisPosition& q_m, const AxisVelocity& qd_mf,
                          const AxisPosition& q_s, const AxisVelocity& qd_s,
                          const CouplingGains& gains) noexcept {
  AxisEffort f(gains.axes);
  for (int i = 0; i < gains.axes; ++i) {
    f[i] = gains.k_pm[i] * (q_s[i] - q_m[i]) +
           gains.gamma[i] * gains.relative_damping[i] * (qd_s[i] - qd_mf[i]);
  }
  return f;
}

}  // namespace wholehand
