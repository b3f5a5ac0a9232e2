#pragma once

#include "report/report_data.hpp"

#include <string>
#include <vector>

namespace wholehand {

/// A picture as the page holds it.
struct EmbeddedPicture {
  std::string caption;
  std::string png_bytes;
};

/// Pixels across the time plots: what collectReport should thin to.
inline constexpr int kReportPlotColumns = 541;

/// The whole page as HTML: A4 landscape sheets with efforts, contacts and timing; movement and
/// settings; pictures.
[[nodiscard]] std::string reportPage(const ReportData& data,
                                     const std::vector<EmbeddedPicture>& pictures);

}  // namespace wholehand
