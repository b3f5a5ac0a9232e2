#include "chart_file.hpp"

#include "assembly/text_file.hpp"
#include "page/page_file.hpp"
#include "shipped_files.hpp"

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

}  // namespace wholehand
