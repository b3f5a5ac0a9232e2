#pragma once

#include "commissioning/identification/axis_trace.hpp"
#include "core/expected.hpp"

#include <string>
#include <vector>

namespace wholehand {

/// Resamples a trace to even periods. Positions are interpolated linearly between readings; efforts
/// are the mean of those held over each period. A trace that was on time is returned bit-identical.
///
/// Refused, with the name of the axis: two ticks more than five periods apart, or more than a
/// twentieth of the ticks half a period off. Interpolation is then too inaccurate.
/// @param taken_s time at which each position was read and its effort sent, from 0 on, increasing
[[nodiscard]] Expected<AxisTrace> evenTrace(const AxisTrace& ticks,
                                            const std::vector<double>& taken_s,
                                            const std::string& axis);

}  // namespace wholehand
