#pragma once

#include "impedance/impedance_measurement.hpp"
#include "page/chart_page.hpp"

namespace wholehand {

/// A Bode plot for every axis: magnitude above phase, predictions as lines, measurements as dots;
/// free, on the spring and against the rigid stop, Φ = 0 and 1.
[[nodiscard]] ChartPage impedanceChart(const ImpedanceReport& report);

}  // namespace wholehand
