#pragma once

#include "control/certificate/certificate_advice.hpp"
#include "core/expected.hpp"

#include <string>
#include <vector>

/// Diagnostics for gains that are not certified.
namespace wholehand {

/// Unit of the axis's stiffness, "N/m"; with time = "·s" of its damping, "N·m·s/rad".
[[nodiscard]] std::string perUnit(const DeviceAxis& axis, const char* time = "");
/// "k_pm_n_m" or "k_pm_nm_rad", as in the rendering file.
[[nodiscard]] std::string stiffnessKey(const DeviceAxis& axis);
/// "k_dm_n_s_m" or "k_dm_nm_s_rad"
[[nodiscard]] std::string dampingKey(const DeviceAxis& axis);
[[nodiscard]] std::string armatureKey(const DeviceAxis& axis);

/// Keys of the criteria that the axis fails, the binding one first.
[[nodiscard]] std::vector<std::string> failing(const AxisCertificate& a);

/// Finding of the axis's binding criterion with its numbers; no full stop.
[[nodiscard]] std::string finding(const AxisCertificate& a);

/// Largest share of the exercise's walls that passes with the axis's present gains, two digits: 0
/// for none, 1 for all.
[[nodiscard]] double bearableWallShare(const AxisCase& c);

/// One diagnostic for each axis that is not certified (key in the rendering file, criterion, value
/// and nearest gains that pass), and one where the coupled axes of the avatar are unstable. Empty
/// exactly when certify().certified. Fast when everything passes.
[[nodiscard]] Diagnostics refuseUncertified(const CertificateInput& input);

}  // namespace wholehand
