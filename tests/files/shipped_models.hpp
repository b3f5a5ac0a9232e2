#pragma once

#include "files/device/device_file.hpp"
#include "files/hand/hand_file.hpp"
#include "files/patient/patient_file.hpp"
#include "loop/model/patient_config.hpp"
#include "support/constants.hpp"
#include "support/figure.hpp"

#include <string>
#include <vector>

/// The shipped models, one by one.
namespace wholehand::test {

inline const std::vector<std::string> kHandSizes = {
    "adult-median", "woman-p05", "woman-p50", "woman-p95", "man-p05", "man-p50", "man-p95"};

inline DeviceModel deviceNamed(const std::string& name = "lambda-pride") {
  return loadDeviceFile(kConfig + "devices/" + name + ".toml").value();
}
inline HandFile handFile(const std::string& name) {
  return loadHandFile(kConfig + "hands/" + name + ".toml").value();
}
inline HandModel handNamed(const std::string& hand = "adult-median-right",
                           const std::string& on = "lambda-pride") {
  return orThrow(assembleHand(handFile(hand), deviceNamed(on)));
}
inline std::string patientPath(const std::string& name) {
  return kConfig + "patients/" + name + ".toml";
}
inline PatientConfig patientNamed(const std::string& name, const std::string& on = "lambda-pride") {
  return loadPatientFile(patientPath(name), deviceNamed(on)).value();
}

}  // namespace wholehand::test
