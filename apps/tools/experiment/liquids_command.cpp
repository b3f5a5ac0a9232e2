#include "apps/tools/experiment/experiment_command.hpp"
#include "apps/wholehand/shared/exit_code.hpp"
#include "apps/wholehand/shared/result_files.hpp"
#include "experiments/liquid_trial.hpp"
#include "files/page/chart_page.hpp"
#include "loop/core/printable.hpp"

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include <algorithm>
#include <cstdio>
#include <iterator>
#include <string>
#include <vector>

namespace wholehand {
namespace {

using Json = nlohmann::ordered_json;
using Liquids = std::vector<LiquidFelt>;

/// A liquid compared with the next thinner one.
struct Step {
  double ratio = 0.0, impedance_change = 0.0, distinguished = 0.0;
};
Step stepOf(const LiquidFelt& thinner, const LiquidFelt& thicker) {
  const double ratio = std::min(thicker.felt_n_s_m[0] / thinner.felt_n_s_m[0],
                                thicker.felt_n_s_m[1] / thinner.felt_n_s_m[1]);
  return {ratio, impedanceChange(thinner, thicker), distinguishedShare(ratio)};
}

Json resultsJson(const Liquids& liquids) {
  Json out = Json::array();
  for (std::size_t i = 0; i < liquids.size(); ++i) {
    const LiquidFelt& l = liquids[i];
    Json one{{"liquid", l.liquid},
             {"resistance_n_s_m", l.resistance_n_s_m},
             {"felt_fingers_n_s_m", l.felt_n_s_m[0]},
             {"felt_thumb_n_s_m", l.felt_n_s_m[1]},
             {"stiffness_n_m", {l.stiffness_n_m.real(), l.stiffness_n_m.imag()}}};
    if (i > 0) {
      const Step step = stepOf(liquids[i - 1], l);
      one["ratio"] = step.ratio;
      one["impedance_change"] = step.impedance_change;
      one["told_apart"] = step.distinguished;
    }
    out.push_back(std::move(one));
  }
  return {{"oscillation_hz", kLiquidHz}, {"liquids", std::move(out)}};
}

void print(const Liquids& liquids) {
  std::printf("%-12s %8s %16s %14s %9s %12s %12s\n", "liquid", "N·s/m", "felt by fingers",
              "by the thumb", "apart", "|dZ|/|Z|", "told apart");
  for (std::size_t i = 0; i < liquids.size(); ++i) {
    const LiquidFelt& l = liquids[i];
    std::printf("%-12s %7.0f %16.0f %14.0f", l.liquid.c_str(), l.resistance_n_s_m, l.felt_n_s_m[0],
                l.felt_n_s_m[1]);
    if (i > 0) {
      const Step step = stepOf(liquids[i - 1], l);
      std::printf(" %9.2f %12.2f %10.0f %%", step.ratio, step.impedance_change,
                  100.0 * step.distinguished);
    }
    std::printf("\n");
  }
}

ChartPage figureOf(const Liquids& liquids) {
  ChartPage page;
  page.title = sentence("felt.title");
  page.notes = {sentence("felt.note", {{"speed", fmt::format("{:.0f}", 1e3 * kSqueeze_m_s)}})};
  Chart chart;
  chart.title = sentence("felt.force");
  chart.height_px = 260;
  chart.x = {"mm", 0.0};
  chart.y = {"", 0.0};
  const char* const colors[] = {"--amber", "--stop", "--focus", "--good", "--ink-2", "--ink"};
  for (std::size_t i = 0; i < liquids.size(); ++i) {
    ChartLine line{fmt::format("{} ({:.0f} N·s/m)", liquids[i].liquid, liquids[i].resistance_n_s_m),
                   colors[i % std::size(colors)],
                   {},
                   2.0};
    line.points = liquids[i].squeeze;
    chart.lines.push_back(std::move(line));
  }
  page.charts = {std::move(chart)};
  return page;
}

}  // namespace

int liquidsCommand(const LiquidsOptions& options) {
  const auto files = barModelFiles(options.files);
  if (!files) return refuse(files.errors());
  const auto paths = prepareResults(options.folder, options.json, "liquids");
  if (!paths) return refuse(paths.errors());
  const auto liquids = feelLiquids(*files);
  if (!liquids) return refuse(liquids.errors());
  print(*liquids);
  if (auto done = writeResults(jsonText(resultsJson(*liquids)), figureOf(*liquids), *paths);
      !done) {
    return refuse(done.errors());
  }
  std::fputs(listed(*paths).c_str(), stdout);
  return kExitDone;
}

}  // namespace wholehand
