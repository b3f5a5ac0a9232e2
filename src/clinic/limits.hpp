#pragma once

#include "clinic/request.hpp"
#include "files/patient/prescription_file.hpp"

#include <string>
#include <vector>

namespace wholehand::clinic {

/// Limits of a person's hand on the device's axes, as the page sends them with the hand and as they
/// are stored: [{"axis": "x", "within_m": [-0.05, 0.06]}, {"axis": "finger_flexion", "within_rad":
/// [0.3, 2.6]}]. Refuses what is none of this; the station compares them with its device.
/// @param field of the request
[[nodiscard]] Json readLimits(const Json& limits, const std::string& field);

/// The same for the file of a prescription.
[[nodiscard]] std::vector<LimitText> limitTexts(const Json& limits);

}  // namespace wholehand::clinic
