#pragma once

#include "certification/certificate_text.hpp"
#include "page/chart_page.hpp"

namespace wholehand {

/// The Z-width of every axis: largest stiffness against adaptive damping, and where the axis works.
/// Axes that nothing but their names tells apart share a chart.
[[nodiscard]] ChartPage certificateChart(const AdvisedCertificate& judged);

}  // namespace wholehand
