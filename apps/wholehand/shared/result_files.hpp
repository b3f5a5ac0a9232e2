#pragma once

#include "files/page/chart_page.hpp"
#include "loop/core/expected.hpp"

#include <string>
#include <vector>

namespace wholehand {

/// JSON as text for a file. Bytes that are not UTF-8, for example in file names, become U+FFFD.
template <class Json>
[[nodiscard]] std::string jsonText(const Json& json, int indent = 2) {
  return json.dump(indent, ' ', false, Json::error_handler_t::replace) + "\n";
}

/// prepareFiles() for a command that also writes a page of charts. Refuses before any measurement
/// if the page's template is missing. Skips empty paths.
[[nodiscard]] Expected<Done> prepareCharts(const std::string& charts_path,
                                           std::vector<std::string> other_paths);

/// Writes the page as a self-contained HTML file.
[[nodiscard]] Expected<Done> writeCharts(const ChartPage& charts, const std::string& path);

/// Files for the results of an experiment and their charts; with an empty path, charts are not
/// drawn.
struct ResultFiles {
  std::string json, charts;
  std::string record = {};  ///< recording; empty: none
};
/// prepareCharts() for `folder`/`name`.html and `folder`/`name`.json, or `json` if it is not empty.
/// If `json` is not empty and the pages are not built, reports on standard error that no charts are
/// drawn.
[[nodiscard]] Expected<ResultFiles> prepareResults(const std::string& folder,
                                                   const std::string& json,
                                                   const std::string& name);
/// Prepares files with other names. @param undrawn charts may be missing if the pages are not built
[[nodiscard]] Expected<ResultFiles> prepareResults(ResultFiles files, bool undrawn);
/// Names of the files, one per line.
[[nodiscard]] std::string listed(const ResultFiles& files);
[[nodiscard]] Expected<Done> writeResults(const std::string& json, const ChartPage& charts,
                                          const ResultFiles& files);

}  // namespace wholehand
