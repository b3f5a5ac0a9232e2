#pragma once

#include "commissioning/identification/axis_trace.hpp"
#include "core/expected.hpp"

#include <string>
#include <vector>

namespace wholehand {

/// A trace whose ticks came at these times, as one of even periods: positions on the straight line
/// between two readings, efforts as the mean of what was held over each period. The same trace, to
/// the bit, where every tick was on time.
///
/// Refused, by the name of the axis: two ticks further apart than five periods, or more than a
/// twentieth of them half a period off: the line between readings says too little then.
/// @param taken_s when each position was read and its effort sent, from 0 on, rising
[[nodiscard]] Expected<AxisTrace> evenTrace(const AxisTrace& ticks,
                                            const std::vector<double>& taken_s,
                                            const std::string& axis);

}  // namespace wholehand
