#pragma once

#include "commissioning/passport.hpp"
#include "model/device_model.hpp"
#include "page/chart_page.hpp"

namespace wholehand {

/// Chart of the measurement against the device file: for each axis and figure its interval relative
/// to the file's value, which lies at 1. Where the file states 0, the interval is given in words
/// only. Not real-time safe.
/// @pre sameAxes()
[[nodiscard]] ChartPage passportChart(const Passport& passport, const DeviceModel& device);

}  // namespace wholehand
