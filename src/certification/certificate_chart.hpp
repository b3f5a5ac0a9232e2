#pragma once

#include "certification/certificate_text.hpp"

#include <string>

namespace wholehand {

/// The Z-width of every axis as small plots in one SVG: largest stiffness against adaptive damping,
/// and where the axis works. Axes that nothing but their names tells apart share a plot.
[[nodiscard]] std::string certificateChart(const AdvisedCertificate& judged);

}  // namespace wholehand
