#pragma once

#include "core/expected.hpp"
#include "page/chart_page.hpp"

#include <string>
#include <vector>

namespace wholehand {

/// prepareFiles() of a command that also writes a page of charts. Refuses before any measurement if
/// the page's template is missing. Skips empty paths.
[[nodiscard]] Expected<Done> prepareCharts(const std::string& charts_path,
                                           std::vector<std::string> other_paths);

/// Writes the page as a self-contained HTML file.
[[nodiscard]] Expected<Done> writeCharts(const ChartPage& charts, const std::string& path);

}  // namespace wholehand
