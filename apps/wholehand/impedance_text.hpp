#pragma once

#include "impedance/impedance_measurement.hpp"

#include <nlohmann/json.hpp>

#include <string>

namespace wholehand {

/// "free", "spring" or "rigid"
[[nodiscard]] const char* contactKey(ContactCase contact);
/// "kg" or "kg·m²"; "N/m" or "N·m/rad"; "N·s/m" or "N·m·s/rad"
[[nodiscard]] std::string massUnit(const DeviceAxis& axis);
[[nodiscard]] std::string stiffnessUnit(const DeviceAxis& axis);
[[nodiscard]] std::string impedanceUnit(const DeviceAxis& axis);

/// The measured points; without any, the predicted ones.
[[nodiscard]] const std::complex<double>& best(const ImpedanceCurve& curve,
                                               const ImpedancePoint& point);

/// A table with a row per curve, the measurement conditions, and the largest deviation.
[[nodiscard]] std::string impedanceText(const ImpedanceReport& report);

/// The JSON under "impedance" (docs/impedance.md).
[[nodiscard]] nlohmann::ordered_json impedanceJson(const ImpedanceReport& report);

}  // namespace wholehand
