#pragma once

#include "commissioning/passport.hpp"
#include "model/device_model.hpp"
#include "page/chart_page.hpp"

namespace wholehand {

/// What was measured against what the device file states: for each axis and figure its interval, as
/// a share of the file's number, which stands at 1. A figure that the file states as 0 has its
/// interval in words only. Not for the tick.
/// @pre sameAxes()
[[nodiscard]] ChartPage passportChart(const Passport& passport, const DeviceModel& device);

}  // namespace wholehand
