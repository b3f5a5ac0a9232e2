#pragma once

#include "devices/commissioning/identification/identify_axis.hpp"

#include <vector>

namespace wholehand {

/// Longest time constant that a device file may state [s].
inline constexpr double kLongestDriveLag_s = 0.02;

/// Time constant with which a drive's measured effort follows the effort sent [s]: a delay of whole
/// periods, a lag of first order and a gain, by least squares over both. The interval holds every
/// lag that explains the effort nearly as well (its residual within a tenth). Its ends are 0 when
/// the drive measures no effort, or another one: then nothing is known. Pure. Not real-time safe.
/// @param effort sent after the sample of each tick [N or N·m]
/// @param given measured in the sample of each tick; NaN: none
[[nodiscard]] Interval identifyDriveLag(const std::vector<double>& effort,
                                        const std::vector<double>& given, double period_s);

}  // namespace wholehand
