#pragma once

#include "files/page/chart_page.hpp"
#include "loop/core/expected.hpp"

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

/// Where an experiment writes its results and their charts; without charts they are not drawn.
struct ResultFiles {
  std::string json, charts;
  std::string record = {};  ///< recording; empty: none
};
/// prepareCharts() of `folder`/`name`.json, or `json` where it is named, and `folder`/`name`.html.
/// Where `json` is named and the pages are not built, says on standard error that nothing is drawn.
[[nodiscard]] Expected<ResultFiles> prepareResults(const std::string& folder,
                                                   const std::string& json,
                                                   const std::string& name);
/// The same of files with other names. @param undrawn allowed where the pages are not built
[[nodiscard]] Expected<ResultFiles> prepareResults(ResultFiles files, bool undrawn);
/// The files' names, a line each.
[[nodiscard]] std::string listed(const ResultFiles& files);
[[nodiscard]] Expected<Done> writeResults(const std::string& json, const ChartPage& charts,
                                          const ResultFiles& files);

}  // namespace wholehand
