#pragma once

#include "commissioning/passport.hpp"
#include "model/device_model.hpp"

#include <string>

namespace wholehand {

/// What was measured against what the device file states, as one SVG in the report's style: for
/// each axis and figure its interval, as a share of the file's number, which stands at 1. A figure
/// that the file states as 0 has its interval in words only. Not for the tick.
/// @pre sameAxes()
[[nodiscard]] std::string passportChart(const Passport& passport, const DeviceModel& device);

}  // namespace wholehand
