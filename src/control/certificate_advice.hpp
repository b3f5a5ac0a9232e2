#pragma once

#include "control/certificate.hpp"

#include <array>
#include <optional>

/// What a certificate advises: the nearest gains that pass, and what the device would admit.
namespace wholehand {

inline constexpr std::array<double, 4> kAdmittedRatesHz = {1000.0, 2000.0, 4000.0, 8000.0};

/// Gains of one axis that pass; typed into the file they still do.
struct NearestGains {
  double k_pm = 0.0, k_dm = 0.0;
  std::optional<double> armature = {};  ///< as in AxisRendering
};

struct AxisAdvice {
  /// Largest K_pm that passes at 1, 2, 4 and 8 kHz with the axis's own γ and K_dm, its own armature
  /// or the rule's, and the same delay in ticks; 0 where none does.
  std::array<double, kAdmittedRatesHz.size()> admitted_k_pm{};
  double best_gamma = 0.0;       ///< of 0, 0.05 .. 1, the one that admits the largest K_pm
  double best_gamma_k_pm = 0.0;  ///< and that K_pm, at the certificate's own rate
};

/// Largest K_pm <= `most` with which the axis meets every criterion of its own, three digits; 0
/// where none does. Absolute stability is searched, and the contacts are then looked at.
[[nodiscard]] double largestStiffness(const AxisCase& c, double most);

/// Whether the axis meets every criterion of its own: what certifyAxis().passes says, without the
/// margins and in a tenth of the time.
[[nodiscard]] bool holds(const AxisCase& c);

/// The nearest gains of one axis by itself; K_pm is 0 where there are none.
[[nodiscard]] NearestGains nearestOfAxis(AxisCase c);

[[nodiscard]] AxisAdvice advise(const AxisCase& c);

/// For every axis the nearest gains (K_pm lowered, K_dm too where that alone does not do, armature
/// added where the avatar shakes, every K_pm by a common factor where only coupled persons and
/// objects ask for it) with which the whole passes. None where only
/// another device would help.
[[nodiscard]] std::optional<std::vector<NearestGains>> nearestGains(const CertificateInput& input,
                                                                    const Certificate& judged);

/// True when nothing but their names (and 1e-4 of the avatar's inertia) tells two axes apart: they
/// share advice and chart.
[[nodiscard]] bool sameCase(const AxisCase& a, const AxisCase& b);

}  // namespace wholehand
