#pragma once

#include "certification/certificate_text.hpp"
#include "page/chart_page.hpp"

namespace wholehand {

/// The Z-width of every axis: largest stable stiffness against adaptive damping, and the operating
/// point. Axes that differ only in their names share a chart.
[[nodiscard]] ChartPage certificateChart(const AdvisedCertificate& judged);

}  // namespace wholehand
