#include "loop/control/bilateral_coupling.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>

namespace wholehand {

namespace {

/// k_p up to which no armature is added. A lighter avatar would gain little, because the lag of the
/// velocity filter dominates the felt mass. Also, a tick of 1 ms resolves the avatar's motion less
/// and less as k_p grows.
constexpr double kLargestWithoutArmaturePerS2 = 5e4;

Diagnostic fault(const RenderingConfig& rendering, std::string key, std::string value,
                 std::string problem, std::string remedy) {
  return keyFault(rendering.path, std::move(key), std::move(value), std::move(problem),
                  std::move(remedy));
}

Diagnostics checkShape(const RenderingConfig& rendering, const AxisMatrix& inertia,
                       double period_s) {
  Diagnostics out;
  const auto n = static_cast<Eigen::Index>(rendering.axes.size());
  if (!(period_s > 0.0) || !std::isfinite(period_s)) {
    out.push_back(fault(rendering, "period_s", fmt::format("{}", period_s), "is no length of time",
                        "must be a finite number > 0 s"));
  }
  if (inertia.rows() != n || inertia.cols() != n) {
    out.push_back(fault(rendering, "axes", fmt::format("{}", n),
                        "does not match the hand's reduced inertia",
                        fmt::format("the hand has {} axes", inertia.rows())));
    return out;
  }
  for (Eigen::Index i = 0; i < n; ++i) {
    if (!(inertia(i, i) > 0.0) || !std::isfinite(inertia(i, i))) {
      out.push_back(fault(rendering, rendering.axes[i].name, fmt::format("{}", inertia(i, i)),
                          "the hand has no inertia along this axis",
                          "let the axis move a link that has mass"));
    }
  }
  return out;
}

}  // namespace

double ruleArmature(double k_pm, double inertia) noexcept {
  return std::max(0.0, k_pm / kLargestWithoutArmaturePerS2 - inertia);
}

double armatureOf(const AxisRendering& axis, double inertia) noexcept {
  return axis.armature.value_or(ruleArmature(axis.k_pm, inertia));
}

AxisMatrix withArmature(const AxisMatrix& reduced_inertia, const AxisInertia& armature) {
  AxisMatrix out = reduced_inertia;
  for (int i = 0; i < armature.size(); ++i) out(i, i) += armature[i];
  return out;
}

AxisDamping avatarDamping(const AxisMatrix& reduced_inertia, const AxisStiffness& k_pm,
                          double period_s) noexcept {
  AxisDamping out(k_pm.size());
  for (int i = 0; i < k_pm.size(); ++i) {
    const double inertia = reduced_inertia(i, i);
    out[i] = inertia * criticalDamping(k_pm[i] / inertia, period_s);
  }
  return out;
}

double feltInertia(const CouplingGains& gains, int axis, double period_s) {
  const double inertia = gains.inertia[axis];
  const double k_d = criticalDamping(gains.k_pm[axis] / inertia, period_s);
  return inertia * (1.0 + (1.0 - gains.gamma[axis]) * k_d * gains.filter_tau_s[axis]);
}

Expected<CouplingGains> resolveGains(const RenderingConfig& rendering,
                                     const AxisMatrix& reduced_inertia_at_reference,
                                     double period_s) {
  Diagnostics errors = checkShape(rendering, reduced_inertia_at_reference, period_s);
  if (!errors.empty()) return errors;

  const int n = static_cast<int>(rendering.axes.size());
  CouplingGains g{
      n,          AxisStiffness(n), AxisDamping(n), AxisRatio(n), AxisInertia(n), AxisInertia(n),
      AxisTime(n)};
  const double largest_per_s2 = 1.0 / (period_s * period_s);
  for (int i = 0; i < n; ++i) {
    const AxisRendering& axis = rendering.axes[i];
    const double own = reduced_inertia_at_reference(i, i);
    g.armature[i] = armatureOf(axis, own);
    g.inertia[i] = own + g.armature[i];
    const double k_p = axis.k_pm / g.inertia[i];
    // Above 1/T² the avatar rings.
    if (!(k_p <= largest_per_s2)) {
      errors.push_back(fault(
          rendering, axis.name + ".armature", fmt::format("{:.6g}", g.armature[i]),
          "lets the simulated hand ring: above K_pm / M = 1/T^2 a pole of its loop is negative",
          fmt::format("must be at least {:.3g}, or run at {:.0f} Hz or faster",
                      axis.k_pm / largest_per_s2 - own, std::ceil(std::sqrt(k_p)))));
      continue;
    }
    g.k_pm[i] = axis.k_pm;
    g.k_dm[i] = axis.k_dm;
    g.gamma[i] = axis.gamma;
    g.filter_tau_s[i] = 1.0 / (2.0 * std::numbers::pi * axis.velocity_filter_hz);
  }
  if (!errors.empty()) return errors;
  return g;
}

VelocityState estimateVelocity(const VelocityState& state, const AxisPosition& q_m,
                               const CouplingGains& gains, int elapsed_periods,
                               double period_s) noexcept {
  VelocityState next;
  next.previous = q_m;
  next.filtered = AxisVelocity(gains.axes);
  next.started = true;
  if (!state.started) return next;
  const double elapsed_s = std::max(elapsed_periods, 1) * period_s;
  for (int i = 0; i < gains.axes; ++i) {
    const double tau_s = gains.filter_tau_s[i];
    next.filtered[i] =
        (tau_s * state.filtered[i] + (q_m[i] - state.previous[i])) / (tau_s + elapsed_s);
  }
  return next;
}

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
