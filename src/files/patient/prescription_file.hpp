#pragma once

#include "loop/core/expected.hpp"
#include "loop/model/device_model.hpp"
#include "loop/model/hand_model.hpp"
#include "loop/model/prescription.hpp"

#include <string>

namespace wholehand {

/// Reads a prescription (kind = "prescription") for a device. Every fault of the file is reported.
/// Format: docs/prescription.md. Not real-time safe.
[[nodiscard]] Expected<Prescription> loadPrescriptionFile(const std::string& path,
                                                          const DeviceModel& device);

/// Text of a prescription's file. Numbers are rounded to a tenth of a millimetre and a milliradian,
/// and stay within the device's range.
[[nodiscard]] std::string prescriptionText(const Prescription& prescription,
                                           const DeviceModel& device);

/// One fault when the prescription is for the other hand; else none.
[[nodiscard]] Diagnostics refuseOtherSide(const Prescription& prescription, const HandModel& hand);

}  // namespace wholehand
