#pragma once

#include "certify/certificate.hpp"
#include "loop/core/expected.hpp"

#include <array>
#include <optional>
#include <string>
#include <vector>

/// Advice for gains that are not certified: diagnostics, the nearest gains that pass, and the gains
/// that the device admits.
namespace wholehand {

inline constexpr std::array<double, 4> kAdmittedRatesHz = {1000.0, 2000.0, 4000.0, 8000.0};

/// Gains of one axis that pass, also when rounded for printing.
struct NearestGains {
  double k_pm = 0.0, k_dm = 0.0;
  std::optional<double> armature = {};  ///< as in AxisRendering
};

struct AxisAdvice {
  /// Largest K_pm that passes at 1, 2, 4 and 8 kHz with the axis's own γ and K_dm, its own armature
  /// or the rule's, and the same delay in ticks; 0 if none passes.
  std::array<double, kAdmittedRatesHz.size()> admitted_k_pm{};
  double best_gamma = 0.0;       ///< the γ among 0, 0.05 .. 1 that admits the largest K_pm
  double best_gamma_k_pm = 0.0;  ///< that K_pm, at the certificate's own rate
};

/// Largest K_pm <= `most` (three digits) that meets every criterion of the axis alone; 0 if none
/// does. Searches by absolute stability, then verifies the contacts.
[[nodiscard]] double largestStiffness(const AxisCase& c, double most);

/// True when the axis meets all single-axis criteria. Equals certifyAxis().passes but takes a tenth
/// of the time and computes no margins.
[[nodiscard]] bool holds(const AxisCase& c);

/// The nearest gains of one axis alone; K_pm is 0 if there are none.
[[nodiscard]] NearestGains nearestOfAxis(AxisCase c);

[[nodiscard]] AxisAdvice advise(const AxisCase& c);

/// The nearest gains of every axis with which the whole device passes. K_pm is lowered; K_dm is
/// lowered too if K_pm alone does not suffice; armature is added if the avatar is unstable; every
/// K_pm is scaled by a common factor if only the coupled criterion requires it. Empty if only
/// another device would help.
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
  double rigid = 0.0;    ///< largest K_pm against a rigid stop without a person, by eigenvalues
  double passive = 0.0;  ///< largest K_pm with any passive person and object
  /// Largest K_pm inside the exercise's walls; equals `passive` without walls.
  double walled = 0.0;
};

/// Z-width of an axis, from no adaptive damping to twice its K_dm (or to its own damping if K_dm is
/// 0), with its own γ and its own or the rule's armature. @pre points >= 2
[[nodiscard]] std::vector<ZWidthPoint> zWidth(const AxisCase& c, int points);

/// Unit of the axis's stiffness, "N/m"; with time = "·s" of its damping, "N·m·s/rad".
[[nodiscard]] std::string perUnit(const DeviceAxis& axis, const char* time = "");
/// "k_pm_n_m" or "k_pm_nm_rad", as in the rendering file.
[[nodiscard]] std::string stiffnessKey(const DeviceAxis& axis);
/// "k_dm_n_s_m" or "k_dm_nm_s_rad"
[[nodiscard]] std::string dampingKey(const DeviceAxis& axis);
[[nodiscard]] std::string armatureKey(const DeviceAxis& axis);

/// Keys of the criteria that the axis fails, the binding one first.
[[nodiscard]] std::vector<std::string> failing(const AxisCertificate& a);

/// Finding for the axis's binding criterion with its numbers, without a full stop.
[[nodiscard]] std::string finding(const AxisCertificate& a);

/// Largest share of the exercise's wall stiffness that passes with the axis's present gains, two
/// digits; 0: none, 1: all.
[[nodiscard]] double bearableWallShare(const AxisCase& c);

/// Equals certify().certified, but takes a tenth of the time and computes no margins.
[[nodiscard]] bool isCertified(const CertificateInput& input);

/// One diagnostic for each axis that is not certified (key in the rendering file, criterion, value
/// and nearest gains that pass), and one if the coupled axes of the avatar are unstable. Empty
/// exactly when isCertified().
[[nodiscard]] Diagnostics refuseUncertified(const CertificateInput& input);

}  // namespace wholehand
