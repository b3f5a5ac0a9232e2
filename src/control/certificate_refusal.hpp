#pragma once

#include "control/certificate_advice.hpp"
#include "core/expected.hpp"

#include <string>
#include <vector>

/// Why gains are not rendered, in words.
namespace wholehand {

/// "N/m", "N·m·s/rad": the unit of the axis's stiffness, or with time = "·s" of its damping.
[[nodiscard]] std::string perUnit(const DeviceAxis& axis, const char* time = "");
/// "k_pm_n_m" or "k_pm_nm_rad", as in the rendering file.
[[nodiscard]] std::string stiffnessKey(const DeviceAxis& axis);
/// "k_dm_n_s_m" or "k_dm_nm_s_rad"
[[nodiscard]] std::string dampingKey(const DeviceAxis& axis);
[[nodiscard]] std::string armatureKey(const DeviceAxis& axis);

/// Keys of the criteria that an axis does not meet, the binding one first.
[[nodiscard]] std::vector<std::string> failing(const AxisCertificate& a);

/// What the binding criterion of an axis found, with its numbers; no full stop.
[[nodiscard]] std::string finding(const AxisCertificate& a);

/// Largest share of the exercise's walls that the axis bears with its gains as they are, two
/// digits; 0 where none is, 1 where the whole is.
[[nodiscard]] double bearableWallShare(const AxisCase& c);

/// One for each axis that is not certified (its key in the rendering file, the criterion, the value
/// and the nearest gains that pass), and one where the avatar's axes shake each other; empty
/// exactly where certify().certified. Quick where all is well.
[[nodiscard]] Diagnostics refuseUncertified(const CertificateInput& input);

}  // namespace wholehand
