#pragma once

#include "core/expected.hpp"
#include "page/chart_page.hpp"

#include <string>
#include <vector>

namespace wholehand {

/// prepareFiles() of a command that also writes a page of charts: refuses, before anything is
/// measured, where its template is missing. Empty paths are passed over.
[[nodiscard]] Expected<Done> prepareCharts(const std::string& charts_path,
                                           std::vector<std::string> other_paths);

/// Writes the page as one HTML file that needs nothing else.
[[nodiscard]] Expected<Done> writeCharts(const ChartPage& charts, const std::string& path);

}  // namespace wholehand
