#pragma once

#include "core/expected.hpp"
#include "model/device_model.hpp"

#include <string>
#include <vector>

namespace wholehand {

/// The person's impedance on one axis: pulls the device towards the intention.
struct PatientAxis {
  std::string name;
  double mass = 0.0;       ///< moves with the device [kg or kg·m²], >= 0
  double damping = 0.0;    ///< [N·s/m or N·m·s/rad], >= 0
  double stiffness = 0.0;  ///< [N/m or N·m/rad], >= 0
};

/// How a recorded motion becomes an intention inside the device's workspace.
struct MotionMapping {
  double margin = 0.05;      ///< share of each axis's range kept free at both ends, 0 .. 0.4
  double speed_share = 0.8;  ///< share of each axis's speed limit that may be used, (0, 1]
  double base_scale = 0.0;   ///< translations are multiplied by it; 0: as large as fits, <= 1
  bool center = true;        ///< translations are shifted to the middle of the workspace
};

/// A patient file: arm and finger impedance, and how motion is mapped. An axis that
/// Wholehand knows (kKnownAxes) but the device has not is ignored; any other name is a fault. An
/// axis of the device that the file does not name feels no person.
struct PatientConfig {
  std::string path;
  std::string name;
  std::vector<PatientAxis> axes;  ///< in the device's order, one for each of its axes
  MotionMapping motion;
};

[[nodiscard]] Expected<PatientConfig> loadPatientFile(const std::string& path,
                                                      const DeviceModel& device);

}  // namespace wholehand
