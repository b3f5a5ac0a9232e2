#pragma once

#include "loop/core/expected.hpp"
#include "loop/model/device_model.hpp"
#include "loop/model/hand_model.hpp"
#include "loop/model/prescription.hpp"

#include <string>
#include <vector>

namespace wholehand {

/// Reads a prescription (kind = "prescription") for a device. Every fault of the file is reported.
/// Format: docs/prescription.md. Not real-time safe.
[[nodiscard]] Expected<Prescription> loadPrescriptionFile(const std::string& path,
                                                          const DeviceModel& device);

/// A limit as its file has it.
struct LimitText {
  std::string axis;
  bool along = true;  ///< within_m, not within_rad
  double lower = 0.0, upper = 0.0;
};
/// Text of a prescription's file with these limits.
/// @param name a code, never a person's name @param side "right" or "left"
[[nodiscard]] std::string prescriptionText(const std::string& name, const std::string& side,
                                           const std::vector<LimitText>& limits);

/// One fault when the prescription is for the other hand; else none.
[[nodiscard]] Diagnostics refuseOtherSide(const Prescription& prescription, const HandModel& hand);

}  // namespace wholehand
