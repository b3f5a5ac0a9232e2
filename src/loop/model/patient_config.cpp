#include "loop/model/patient_config.hpp"

#include <algorithm>
#include <limits>

namespace wholehand {

double reflexFreeOpeningSpeed(const PatientConfig& patient) noexcept {
  double slowest = std::numeric_limits<double>::infinity();
  for (const PatientAxis& axis : patient.axes) {
    if (axis.reflex.gain_nm_s_rad2 > 0.0) slowest = std::min(slowest, axis.reflex.from_speed_rad_s);
  }
  return slowest;
}

}  // namespace wholehand
