#include "control/coupling_gains.hpp"

#include "control/critical_damping.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>

namespace wholehand {

namespace {

/// Beyond it a lighter avatar gains nothing: the velocity filter's lag rules the felt mass.
constexpr double kLargestRuleStiffnessPerS2 = 5e4;

Diagnostic fault(const RenderingConfig& rendering, std::string key, std::string value,
                 std::string problem, std::string remedy) {
  return {rendering.path,   0, std::move(key), std::move(value), std::move(problem),
          std::move(remedy)};
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

double ruleStiffness(double k_pm, double inertia) noexcept {
  return std::min(k_pm / inertia, kLargestRuleStiffnessPerS2);
}

Expected<CouplingGains> resolveGains(const RenderingConfig& rendering,
                                     const AxisMatrix& reduced_inertia_at_reference,
                                     double period_s) {
  Diagnostics errors = checkShape(rendering, reduced_inertia_at_reference, period_s);
  if (!errors.empty()) return errors;

  const int n = static_cast<int>(rendering.axes.size());
  CouplingGains g{n,
                  AxisRatio(n),
                  AxisRatio(n),
                  AxisRatio(n),
                  AxisRatio(n),
                  AxisRatio(n),
                  AxisRatio(n),
                  AxisRatio(n),
                  AxisRatio(n)};
  const double largest_per_s2 = 1.0 / (period_s * period_s);
  for (int i = 0; i < n; ++i) {
    const AxisRendering& axis = rendering.axes[i];
    const double inertia = reduced_inertia_at_reference(i, i);
    const double k_ps =
        axis.k_ps_per_s2 > 0.0 ? axis.k_ps_per_s2 : ruleStiffness(axis.k_pm, inertia);
    if (!(k_ps <= largest_per_s2)) {
      errors.push_back(fault(
          rendering, axis.name + ".k_ps_per_s2", fmt::format("{:.6g}", k_ps),
          "makes the simulated hand ring: above 1/T^2 a pole of its loop is negative",
          fmt::format("must be at most {:.6g} 1/s^2 at {:.6g} Hz, or run at {:.0f} Hz or faster",
                      largest_per_s2, 1.0 / period_s, std::ceil(std::sqrt(k_ps)))));
      continue;
    }
    g.k_pm[i] = axis.k_pm;
    g.k_dm[i] = axis.k_dm;
    g.gamma[i] = axis.gamma;
    g.k_ps_per_s2[i] = k_ps;
    g.k_ds_per_s[i] = criticalDamping(k_ps, period_s);
    g.relative_damping[i] = axis.k_pm * g.k_ds_per_s[i] / k_ps;
    g.filter_tau_s[i] = 1.0 / (2.0 * std::numbers::pi * axis.velocity_filter_hz);
    g.contact_scale[i] = axis.k_pm / (k_ps * inertia);
  }
  if (!errors.empty()) return errors;
  return g;
}

}  // namespace wholehand
