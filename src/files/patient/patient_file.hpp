#pragma once

#include "loop/core/expected.hpp"
#include "loop/model/device_model.hpp"
#include "loop/model/patient_config.hpp"

#include <string>

namespace wholehand {

/// Reads and checks a patient file for a device. Reports every fault at once.
[[nodiscard]] Expected<PatientConfig> loadPatientFile(const std::string& path,
                                                      const DeviceModel& device);

}  // namespace wholehand
