#pragma once

#include "core/expected.hpp"
#include "page/chart_page.hpp"

#include <string>
#include <vector>

namespace wholehand {

/// JSON as text of a file. Bytes that are not UTF-8, such as in file names, become U+FFFD.
template <class Json>
[[nodiscard]] std::string jsonText(const Json& json, int indent = 2) {
  return json.dump(indent, ' ', false, Json::error_handler_t::replace) + "\n";
}

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
