#include "apps/wholehand/shared/result_files.hpp"

#include "apps/wholehand/shared/shipped_files.hpp"
#include "files/page/chart_page.hpp"
#include "files/text/text_file.hpp"
#include "loop/core/printable.hpp"

#include <cstdio>
#include <utility>

namespace wholehand {

Expected<Done> prepareCharts(const std::string& charts_path, std::vector<std::string> other_paths) {
  if (!charts_path.empty()) {
    const auto page_template = readPageTemplate(shippedFile(kChartTemplate));
    if (!page_template) return page_template.errors();
  }
  other_paths.push_back(charts_path);
  return prepareFiles(other_paths);
}

Expected<Done> writeCharts(const ChartPage& charts, const std::string& path) {
  const auto page_template = readPageTemplate(shippedFile(kChartTemplate));
  if (!page_template) return page_template.errors();
  return writePage(*page_template, chartPageJson(charts), path);
}

Expected<ResultFiles> prepareResults(const std::string& folder, const std::string& json,
                                     const std::string& name) {
  return prepareResults(
      {json.empty() ? folder + "/" + name + ".json" : json, folder + "/" + name + ".html"},
      !json.empty());
}

Expected<ResultFiles> prepareResults(ResultFiles files, bool undrawn) {
  const auto page = readPageTemplate(shippedFile(kChartTemplate));
  if (!page && !undrawn) return page.errors();
  if (auto ready = prepareFiles({files.charts, files.json, files.record}); !ready) {
    return ready.errors();
  }
  if (!page) {
    std::fprintf(stderr, "Nothing is drawn: %s\n", format(page.errors()).c_str());
    files.charts.clear();
  }
  return files;
}

std::string listed(const ResultFiles& files) {
  std::string lines;
  for (const std::string& file : {files.json, files.charts, files.record}) {
    if (!file.empty()) lines += printable(file) + "\n";
  }
  return lines;
}

Expected<Done> writeResults(const std::string& json, const ChartPage& charts,
                            const ResultFiles& files) {
  if (auto done = writeText(files.json, json); !done) return done;
  if (files.charts.empty()) return Done{};
  return writeCharts(charts, files.charts);
}

}  // namespace wholehand
