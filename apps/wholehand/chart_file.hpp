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

/// Where an experiment writes its results and their charts.
struct ResultFiles {
  std::string json, charts;
};
/// prepareCharts() of `folder`/`name`.json, or `json` where it is named, and `folder`/`name`.html.
[[nodiscard]] Expected<ResultFiles> prepareResults(const std::string& folder,
                                                   const std::string& json,
                                                   const std::string& name);
[[nodiscard]] Expected<Done> writeResults(const std::string& json, const ChartPage& charts,
                                          const ResultFiles& files);

}  // namespace wholehand
