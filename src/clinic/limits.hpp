#pragma once

#include "clinic/request.hpp"

#include <cstdint>
#include <string>

namespace wholehand::clinic {

/// Limits of a person's hand on the device's axes, as the page sends them with the hand and as they
/// are stored: [{"axis": "x", "within_m": [-0.05, 0.06]}, {"axis": "finger_flexion", "within_rad":
/// [0.3, 2.6]}]. Refuses what is none of this; the station compares them with its device.
/// @param field of the request
[[nodiscard]] Json readLimits(const Json& limits, const std::string& field);

/// Text of the prescription with these limits (docs/prescription.md). It names the visit, never the
/// person.
[[nodiscard]] std::string prescriptionText(const Json& limits, std::int64_t visit,
                                           const std::string& side);

}  // namespace wholehand::clinic
