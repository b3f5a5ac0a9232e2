#pragma once

#include "report/report_data.hpp"

#include <string>

namespace wholehand {

/// The stacked time plots of the first sheet: efforts, Φ, contact force. `height_px` in all.
[[nodiscard]] std::string effortPlots(const ReportData& data, int height_px);
/// The stacked time plots of the second sheet: positions of device and avatar, palm, contacts.
[[nodiscard]] std::string movementPlots(const ReportData& data, int height_px);
/// Time per tick, counted on a logarithmic scale, with the deadline.
[[nodiscard]] std::string timingPlot(const ReportData& data);
/// The touches that are numbered in the plots: the longest and hardest ones, in order of time.
[[nodiscard]] std::vector<Touch> numberedTouches(const ReportData& data);

}  // namespace wholehand
