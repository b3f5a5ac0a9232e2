#pragma once

#include "impedance/impedance_measurement.hpp"

#include <string>

namespace wholehand {

/// A Bode plot for every axis in one SVG: magnitude above phase, predictions as lines, measurements
/// as dots; free, on the spring and against the rigid stop, Φ = 0 and 1.
[[nodiscard]] std::string impedanceChart(const ImpedanceReport& report);

}  // namespace wholehand
