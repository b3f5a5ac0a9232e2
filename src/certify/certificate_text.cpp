#include "certify/certificate_text.hpp"

#include "certify/certificate_refusal.hpp"
#include "loop/core/printable.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <utility>

namespace wholehand {
namespace {

/// "1.27"; "-" if there is no wall or no limit.
std::string marginWord(double margin) {
  return margin > 0.0 && std::isfinite(margin) ? fmt::format("{:.3g}", margin) : "-";
}

/// Four digits, never "1.2e+04"; "-" if there is no limit.
std::string limitWord(double limit) {
  if (!std::isfinite(limit)) return "-";
  return limit < 1e4 ? fmt::format("{:.4g}", limit) : fmt::format("{:.0f}", limit);
}

/// "at 124 Hz"; "at rest" below 0.1 Hz.
std::string frequencyWord(double frequency_hz) {
  return frequency_hz < 0.1 ? "at rest" : fmt::format("at {:.3g} Hz", frequency_hz);
}

// Tables are at most 80 characters wide, so that terminals do not wrap them.

std::string contactTable(const Certificate& c) {
  std::string out = fmt::format("{:>47}  worst spectral radius\n", "rigid");
  out += fmt::format("{:<20}{:>8} {:<9}{:>9}{:>8}{:>8}{:>8}{:>8}\n", "axis", "K_pm", "", "limit",
                     "free", "rigid", "mass", "spring");
  for (const AxisCertificate& a : c.axes) {
    out += fmt::format("{:<20}{:>8.4g} {:<9}{:>9}", a.axis_case.axis.name, a.axis_case.gains.k_pm,
                       perUnit(a.axis_case.axis), limitWord(a.rigid_limit));
    for (const WorstRadius& w : a.contacts) out += fmt::format("{:>8.5f}", w.radius);
    out += "\n";
  }
  return out + fmt::format(
                   "all axes: spectral radius {:.5f} (worst of {} posture{}), margin {:.3g}"
                   "  {}\n",
                   c.avatar.radius, c.avatar.postures, plural(c.avatar.postures), c.avatar.margin,
                   c.avatar.passes() ? "passes" : "FAILS: avatar");
}

std::string marginTable(const Certificate& c) {
  std::string out = fmt::format("\n{:>33}{:>16}{:>18}\n", "damping", "quantisation", "margin of");
  out += fmt::format("{:<20}{:>8}{:>8}{:>13}{:>7}{:>7}{:>7}\n", "axis", "needs", "has", "limit",
                     "wall", "slew", "all");
  for (const AxisCertificate& a : c.axes) {
    out += fmt::format("{:<20}{:>8.3g}{:>8.3g}{:>13}{:>7}{:>7}{:>7.3g}  {}\n",
                       a.axis_case.axis.name, a.damping_required, a.axis_case.axis.damping,
                       limitWord(a.quantisationLimit()), marginWord(a.wall.margin),
                       marginWord(a.axis_case.axis.effort_slew_limit / a.slew_required), a.margin,
                       a.passes ? "passes" : "FAILS");
    if (!a.passes) out += fmt::format("  fails: {}\n", fmt::join(failing(a), ", "));
  }
  out += fmt::format("axes linked by person and object: damping margin {:.3g} ({})  {}\n",
                     c.coupled.margin, frequencyWord(c.coupled.frequency_hz),
                     c.coupled.margin >= 1.0 ? "passes" : "FAILS: coupled");
  return out + fmt::format("also nonlinear, time-varying ones: damping margin {:.3g} ({})  {}\n",
                           c.any_person.margin, frequencyWord(c.any_person.frequency_hz),
                           c.any_person.margin >= 1.0 ? "passes" : "not proven");
}

std::string admittedTable(const AdvisedCertificate& judged) {
  std::string out = fmt::format("\n{:<20}", "largest K_pm at");
  for (const double rate_hz : kAdmittedRatesHz) {
    out += fmt::format("{:>8}", fmt::format("{:.0f} kHz", rate_hz / 1e3));
  }
  out += fmt::format(" {:<7}{:>6}{:>7}{:>7}\n", "", "γ", "best γ", "admits");
  for (std::size_t i = 0; i < judged.advice.size(); ++i) {
    const AxisCertificate& a = judged.certificate.axes[i];
    const AxisAdvice& advice = judged.advice[i];
    out += fmt::format("{:<20}", a.axis_case.axis.name);
    for (const double k_pm : advice.admitted_k_pm) out += fmt::format("{:>8.4g}", k_pm);
    out += fmt::format(" {:<7}{:>6.2f}{:>7.2f}{:>7.4g}\n", perUnit(a.axis_case.axis),
                       a.axis_case.gains.gamma, advice.best_gamma, advice.best_gamma_k_pm);
  }
  return out + fmt::format("(best γ: the one that admits the largest K_pm at {:.4g} Hz)\n",
                           1.0 / judged.certificate.period_s);
}

/// Changes on one axis, e.g. "k_pm_n_m = 478"; empty if there are none.
std::string change(const AxisCertificate& a, const NearestGains& to) {
  std::string out;
  const auto set = [&](const std::string& key, double present, double value) {
    if (value != present) out += fmt::format("{}{} = {:.6g}", out.empty() ? "" : ", ", key, value);
  };
  set(stiffnessKey(a.axis_case.axis), a.axis_case.gains.k_pm, to.k_pm);
  set(dampingKey(a.axis_case.axis), a.axis_case.gains.k_dm, to.k_dm);
  if (to.armature)
    set(armatureKey(a.axis_case.axis), a.axis_case.gains.armature.value_or(-1.0), *to.armature);
  return out;
}

/// Changes to type into the rendering file; axes with equal changes are listed together.
std::string remedy(const AdvisedCertificate& judged) {
  if (!judged.nearest) {
    std::string out =
        "no smaller gains pass: the device needs more damping, less delay or a faster loop";
    for (const AxisCertificate& a : judged.certificate.axes) {
      if (a.wall.margin >= 1.0) continue;
      out += fmt::format(", or the wall on {} softened to {:.2g} of itself", a.axis_case.axis.name,
                         bearableWallShare(a.axis_case));
    }
    return out;
  }
  std::vector<std::pair<std::string, std::string>> changes;  // (change, axes)
  for (std::size_t i = 0; i < judged.nearest->size(); ++i) {
    const AxisCertificate& a = judged.certificate.axes[i];
    const std::string what = change(a, (*judged.nearest)[i]);
    if (what.empty()) continue;
    const auto same = std::find_if(changes.begin(), changes.end(),
                                   [&](const auto& known) { return known.first == what; });
    if (same == changes.end()) {
      changes.emplace_back(what, a.axis_case.axis.name);
    } else {
      same->second += ", " + a.axis_case.axis.name;
    }
  }
  std::string out;
  for (const auto& [what, axes] : changes) {
    out += fmt::format("{}{} on {}", out.empty() ? "these gains pass: " : "; ", what, axes);
  }
  return out;
}

std::string verdict(const AdvisedCertificate& judged) {
  const Certificate& c = judged.certificate;
  const std::string posture =
      fmt::format("in posture {} of {}", c.avatar.posture + 1, c.avatar.postures);
  std::string what;
  if (c.binding_axis >= 0) {
    const AxisCertificate& a = c.axes[c.binding_axis];
    what = a.axis_case.axis.name + ": " + finding(a);
  } else if (c.binding_criterion == Criterion::kCoupled) {
    what = fmt::format(
        "all axes together: a passive person and object that link them need {:.3g} of the device's "
        "damping ({})",
        1.0 / c.coupled.margin, frequencyWord(c.coupled.frequency_hz));
  } else if (c.certified) {
    what =
        fmt::format("the avatar: {:.3g} times its stiffness would let its axes shake each other {}",
                    c.avatar.margin, posture);
  } else if (c.avatar.radius < 1.0) {
    what = fmt::format("the avatar follows too slowly {} ({:.3g} s)", posture, c.avatar.slowest_s);
  } else {
    what = fmt::format("the avatar's axes shake each other {} (spectral radius {:.5g})", posture,
                       c.avatar.radius);
  }
  const double rate_hz = 1.0 / c.period_s;
  if (c.certified) {
    return fmt::format("Certified at {:.4g} Hz with a margin of {:.3g}; the tightest is {}.\n",
                       rate_hz, c.margin(), what);
  }
  return fmt::format("NOT certified at {:.4g} Hz: {}; {}.\n", rate_hz, what, remedy(judged));
}

}  // namespace

std::string certificateText(const AdvisedCertificate& judged) {
  std::string walls =
      judged.input.exercise.empty() ? std::string{} : " and the walls of " + judged.input.exercise;
  if (judged.input.level > 0) walls += fmt::format(", level {}", judged.input.level);
  const std::string corner = judged.corner.empty() ? "" : "at " + judged.corner + "\n";
  return fmt::format("{} with the gains {}, the hand {}{}\n{}\n", judged.input.device.name,
                     judged.input.rendering.name, judged.input.hand, walls, corner) +
         contactTable(judged.certificate) + marginTable(judged.certificate) +
         admittedTable(judged) + "\n" + verdict(judged);
}

}  // namespace wholehand
