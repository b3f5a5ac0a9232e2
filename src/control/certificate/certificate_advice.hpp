#pragma once

#include "control/certificate/certificate.hpp"

#include <array>
#include <optional>

/// Advice of a certificate: the nearest gains that pass, and the gains that the device admits.
namespace wholehand {

inline constexpr std::array<double, 4> kAdmittedRatesHz = {1000.0, 2000.0, 4000.0, 8000.0};

/// Gains of one axis that pass, also as printed.
struct NearestGains {
  double k_pm = 0.0, k_dm = 0.0;
  std::optional<double> armature = {};  ///< as in AxisRendering
};

struct AxisAdvice {
  /// Largest K_pm that passes at 1, 2, 4 and 8 kHz with the axis's own γ and K_dm, its own armature
  /// or the rule's, and the same delay in ticks; 0 where none passes.
  std::array<double, kAdmittedRatesHz.size()> admitted_k_pm{};
  double best_gamma = 0.0;       ///< of 0, 0.05 .. 1, the γ that admits the largest K_pm
  double best_gamma_k_pm = 0.0;  ///< that K_pm, at the certificate's own rate
};

/// Largest K_pm <= `most` that meets every criterion of the axis alone, three digits; 0 where none
/// does. Searches by absolute stability, then verifies the contacts.
[[nodiscard]] double largestStiffness(const AxisCase& c, double most);

/// Whether the axis meets every criterion of its own. Same answer as certifyAxis().passes in a
/// tenth of the time, without the margins.
[[nodiscard]] bool holds(const AxisCase& c);

/// The nearest gains of one axis alone; K_pm is 0 where there are none.
[[nodiscard]] NearestGains nearestOfAxis(AxisCase c);

[[nodiscard]] AxisAdvice advise(const AxisCase& c);

/// The nearest gains of every axis with which the whole device passes: K_pm lowered; K_dm lowered
/// too where K_pm alone does not suffice; armature added where the avatar is unstable; every K_pm
/// scaled by a common factor where only the coupled criterion demands it. None where only another
/// device would help.
[[nodiscard]] std::optional<std::vector<NearestGains>> nearestGains(const CertificateInput& input,
                                                                    const Certificate& judged);

[[nodiscard]] CertificateInput withGains(CertificateInput input,
                                         const std::vector<NearestGains>& nearest);

/// True when two axes differ only in their names (and by at most 1e-4 of the avatar's inertia).
/// They share advice and chart.
[[nodiscard]] bool sameCase(const AxisCase& a, const AxisCase& b);

/// Stiffnesses that an axis can render at one constant adaptive damping.
struct ZWidthPoint {
  double damping = 0.0;  ///< Φ K_dm [N·s/m or N·m·s/rad]
  double rigid = 0.0;    ///< largest K_pm against a rigid stop, nobody attached, by eigenvalues
  double passive = 0.0;  ///< largest K_pm with any passive person and object
  double walled = 0.0;   ///< the same inside the exercise's walls; `passive` without walls
};

/// Z-width of an axis, from no adaptive damping to twice its K_dm (to its own damping where K_dm is
/// 0), with its own γ and its own or the rule's armature. @pre points >= 2
[[nodiscard]] std::vector<ZWidthPoint> zWidth(const AxisCase& c, int points);

}  // namespace wholehand
