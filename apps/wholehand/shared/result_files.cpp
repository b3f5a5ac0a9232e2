#include "apps/wholehand/shared/result_files.hpp"

#include "apps/wholehand/shared/shipped_files.hpp"
#include "files/text_file.hpp"
#include "page/page_file.hpp"

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
  ResultFiles files{json.empty() ? folder + "/" + name + ".json" : json,
                    folder + "/" + name + ".html"};
  if (auto ready = prepareCharts(files.charts, {files.json}); !ready) return ready.errors();
  return files;
}

Expected<Done> writeResults(const std::string& json, const ChartPage& charts,
                            const ResultFiles& files) {
  if (auto done = writeText(files.json, json); !done) return done;
  return writeCharts(charts, files.charts);
}

}  // namespace wholehand
