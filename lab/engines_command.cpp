#include "apps/tools/experiment/experiment_command.hpp"
#include "apps/wholehand/shared/exit_code.hpp"
#include "apps/wholehand/shared/result_files.hpp"
#include "apps/wholehand/shared/shipped_files.hpp"
#include "lab/engine_trial.hpp"
#include "loop/core/printable.hpp"
#include "loop/runtime/interrupt_scope.hpp"

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include <algorithm>
#include <array>
#include <cstdio>
#include <string>
#include <utility>
#include <vector>

namespace wholehand {
namespace {

/// A figure of every engine: key, unit, and how it is shown to a person.
struct Row {
  const char* key;
  const char* sentence;
  const char* text;
  double scale;  ///< factor from SI units to the shown unit
  double EngineFigures::*value;
};
constexpr std::array kRows{
    Row{"penetration_m", "engines.penetration", "deepest overlap, mm", 1e3,
        &EngineFigures::penetration_m},
    Row{"virtual_work_error", "engines.virtualWork", "virtual work off by, %", 1e2,
        &EngineFigures::virtual_work_error},
    Row{"felt_error", "engines.felt", "felt against acted, %", 1e2, &EngineFigures::felt_error},
    Row{"slip_m", "engines.slip", "slip in the hold, mm", 1e3, &EngineFigures::slip_m},
    Row{"noise_n", "engines.noise", "noise in the hold, N rms", 1.0, &EngineFigures::noise_n},
    Row{"coupling_error_rad", "engines.coupling", "coupling error, mrad", 1e3,
        &EngineFigures::coupling_error_rad},
    Row{"energy_drift_j", "engines.energy", "energy drift at rest, mJ", 1e3,
        &EngineFigures::energy_drift_j}};

constexpr std::array<const char*, 4> kEngineColors{"--ax-x", "--ax-y", "--ax-z", "--ax-f"};

EngineScene sceneAt(int index) {
  return static_cast<EngineScene>(index);
}

const TickCost& costOf(const EngineFigures& e, int scene) {
  return e.cost.at(static_cast<std::size_t>(scene));
}

/// Upper bounds of the bins that the paper's Fig. 6 uses [µs]; the last bin has no bound.
constexpr std::array kFig6Bins_us{10.0, 20.0, 50.0, 100.0, 200.0, 500.0, 1000.0};

/// Number of ticks in each bin.
std::array<std::size_t, kFig6Bins_us.size() + 1> binned(const std::vector<double>& sorted_us) {
  std::array<std::size_t, kFig6Bins_us.size() + 1> counts{};
  std::size_t before = 0;
  for (std::size_t i = 0; i < kFig6Bins_us.size(); ++i) {
    const auto end = std::upper_bound(sorted_us.begin(), sorted_us.end(), kFig6Bins_us.at(i));
    const auto below = static_cast<std::size_t>(end - sorted_us.begin());
    counts.at(i) = below - before;
    before = below;
  }
  counts.back() = sorted_us.size() - before;
  return counts;
}

nlohmann::ordered_json engineJson(const EngineFigures& e) {
  nlohmann::ordered_json json;
  json["engine"] = e.engine;
  for (int i = 0; i < kEngineScenes; ++i) {
    json["cpu_us"][engineSceneName(sceneAt(i))] = {{"p50", costOf(e, i).p50_us},
                                                   {"p999", costOf(e, i).p999_us}};
  }
  for (const Row& row : kRows) json[row.key] = e.*row.value;
  json["gripped_share"] = e.gripped;
  json["gripped_counts"] = binned(costOf(e, static_cast<int>(EngineScene::kGripped)).times_us);
  json["held"] = e.held;
  json["faulted"] = e.faulted;
  if (e.stiffness.bound_n_m > 0.0) {
    json["stiffness"] = {{"largest_stable_n_m", e.stiffness.found_n_m},
                         {"certificate_bound_n_m", e.stiffness.bound_n_m}};
  } else {
    json["stiffness"] = nullptr;
  }
  return json;
}

nlohmann::ordered_json comparisonJson(const EngineComparison& all) {
  nlohmann::ordered_json json;
  json["rate_hz"] = all.rate_hz;
  json["bins_us"] = kFig6Bins_us;
  json["engines"] = nlohmann::ordered_json::array();
  for (const EngineFigures& e : all.engines) json["engines"].push_back(engineJson(e));
  for (int i = 0; i < kEngineScenes; ++i) {
    json["default_over_paper"][engineSceneName(sceneAt(i))] = all.ratioToPaper(sceneAt(i));
  }
  return json;
}

/// JSON of the comparison at the first rate, and of the comparisons at all rates.
nlohmann::ordered_json allJson(const std::vector<EngineComparison>& rates) {
  nlohmann::ordered_json json = comparisonJson(rates.front());
  json["rates"] = nlohmann::ordered_json::array();
  for (const EngineComparison& at : rates) json["rates"].push_back(comparisonJson(at));
  return json;
}

/// "654 N/m, 0.98 of the certificate's bound"; "-" if it was not searched.
std::string stiffnessWords(const EngineFigures& e) {
  if (!(e.stiffness.bound_n_m > 0.0)) return "-";
  return fmt::format("{:.0f} ({:.2f})", e.stiffness.found_n_m, e.stiffness.share());
}

/// Cumulative distribution of tick times.
Chart costChart(const EngineComparison& all, int scene) {
  constexpr std::size_t kPoints = 200;
  Chart chart;
  chart.title = sentence((std::string("engines.chart.") + engineSceneName(sceneAt(scene))).c_str());
  chart.height_px = 180;
  chart.x = {"µs", 1.0, 1000.0, true};
  chart.y = {"", 0.0, 1.05, false, {0.0, 0.25, 0.5, 0.75, 1.0}};
  for (std::size_t e = 0; e < all.engines.size(); ++e) {
    const std::vector<double>& times = costOf(all.engines[e], scene).times_us;
    ChartLine line{all.engines[e].engine, kEngineColors.at(e % kEngineColors.size())};
    line.stepped = true;
    double last_us = 1.0;
    line.points = {{last_us, 0.0}};
    for (std::size_t k = 1; k <= kPoints && !times.empty(); ++k) {
      const double us = std::clamp(times[k * times.size() / kPoints - 1], 1.0, 1000.0);
      if (us <= last_us) continue;
      line.points.push_back({us, static_cast<double>(k) / kPoints});
      last_us = us;
    }
    if (last_us < 1000.0) line.points.push_back({1000.0, 1.0});
    chart.lines.push_back(std::move(line));
  }
  return chart;
}

ChartTable figuresTable(const EngineComparison& all) {
  ChartTable table;
  table.title = sentence("engines.table", {{"rate", fmt::format("{:.0f}", all.rate_hz)}});
  table.heads = {sentence("timing.what")};
  for (const EngineFigures& e : all.engines) table.heads.emplace_back(e.engine);
  for (int i = 0; i < kEngineScenes; ++i) {
    const std::string name = std::string("engines.cost.") + engineSceneName(sceneAt(i));
    std::vector<PageText> row{sentence(name.c_str())};
    for (const EngineFigures& e : all.engines) {
      row.push_back(fmt::format("{:.1f} / {:.1f}", costOf(e, i).p50_us, costOf(e, i).p999_us));
    }
    table.rows.push_back(std::move(row));
  }
  for (const Row& shown : kRows) {
    std::vector<PageText> row{sentence(shown.sentence)};
    for (const EngineFigures& e : all.engines) {
      row.push_back(fmt::format("{:.3g}", e.*shown.value * shown.scale));
    }
    table.rows.push_back(std::move(row));
  }
  std::vector<PageText> held{sentence("engines.held")};
  for (const EngineFigures& e : all.engines) {
    held.push_back(sentence(e.held ? "engines.yes" : "engines.no"));
  }
  table.rows.push_back(std::move(held));
  std::vector<PageText> gripped{sentence("engines.gripped")};
  for (const EngineFigures& e : all.engines) {
    gripped.emplace_back(fmt::format("{:.1f}", 100.0 * e.gripped));
  }
  table.rows.push_back(std::move(gripped));
  std::vector<PageText> stiffness{sentence("engines.stiffness")};
  for (const EngineFigures& e : all.engines) stiffness.emplace_back(stiffnessWords(e));
  table.rows.push_back(std::move(stiffness));
  return table;
}

ChartPage comparisonPage(const std::vector<EngineComparison>& rates) {
  ChartPage page;
  page.title = sentence("engines.title");
  page.notes = {sentence("engines.note")};
  for (int i = 0; i < kEngineScenes; ++i) page.charts.push_back(costChart(rates.front(), i));
  for (const EngineComparison& at : rates) page.tables.push_back(figuresTable(at));
  return page;
}

void print(const EngineComparison& all) {
  std::printf("\n%-28s", fmt::format("at {:.0f} Hz", all.rate_hz).c_str());
  for (const EngineFigures& e : all.engines) std::printf(" %18s", e.engine.c_str());
  std::printf("\n");
  for (int i = 0; i < kEngineScenes; ++i) {
    const std::string name = fmt::format("{}, µs p50 / p99.9", engineSceneName(sceneAt(i)));
    std::printf("%s%*s", name.c_str(), 29 - static_cast<int>(name.size()),
                "");  // the width counts bytes, and µ has two
    for (const EngineFigures& e : all.engines) {
      std::printf(" %9.1f / %6.1f", costOf(e, i).p50_us, costOf(e, i).p999_us);
    }
    std::printf("\n");
  }
  for (const Row& row : kRows) {
    std::printf("%-28s", row.text);
    for (const EngineFigures& e : all.engines) std::printf(" %18.3g", e.*row.value * row.scale);
    std::printf("\n");
  }
  std::printf("%-28s", "free cylinder held");
  for (const EngineFigures& e : all.engines) std::printf(" %18s", e.held ? "yes" : "no");
  std::printf("\n%-28s", "stable N/m (of the bound)");
  for (const EngineFigures& e : all.engines) std::printf(" %18s", stiffnessWords(e).c_str());
  std::printf("\n%s's tick over bullet-paper's:", all.engines.front().engine.c_str());
  for (int i = 0; i < kEngineScenes; ++i) {
    std::printf(" %s %.3f%s", engineSceneName(sceneAt(i)), all.ratioToPaper(sceneAt(i)),
                i + 1 < kEngineScenes ? "," : "\n");
  }
}

/// Prints the distribution of tick times as in the paper's Fig. 6.
void printDistribution(const EngineComparison& all) {
  std::printf("ticks by CPU time while a cylinder is gripped and every joint moves\n");
  std::printf("%-28s", "up to, µs");
  for (const double bound_us : kFig6Bins_us) std::printf(" %8.0f", bound_us);
  std::printf(" %8s %8s %8s\n", "above", "longest", "gripped");
  for (const EngineFigures& e : all.engines) {
    const std::vector<double>& times_us =
        costOf(e, static_cast<int>(EngineScene::kGripped)).times_us;
    std::printf("%-27s", e.engine.c_str());
    for (const std::size_t count : binned(times_us)) std::printf(" %8zu", count);
    std::printf(" %8.0f %6.1f %%\n", times_us.empty() ? 0.0 : times_us.back(), 100.0 * e.gripped);
  }
}

EnginePlan enginePlan(const ExperimentOptions& options) {
  EnginePlan plan;
  plan.folder = options.folder;
  plan.hold_s = options.hold_s;
  plan.gripped_ticks = options.ticks;
  plan.files = shippedModels();
  plan.resting_file = shippedFile("config/scenes/table.toml");
  plan.status = [](const char* scene) {
    std::printf("%s\n", scene);
    std::fflush(stdout);
  };
  return plan;
}

}  // namespace

int enginesCommand(const ExperimentOptions& options) {
  const InterruptScope interrupts;
  const auto files = prepareResults(options.folder, options.json, "engines");
  if (!files) return refuse(files.errors());
  std::vector<EngineComparison> rates;
  for (const double rate_hz : options.rates_hz) {
    EnginePlan plan = enginePlan(options);
    plan.rate_hz = rate_hz;
    std::printf("%.0f Hz\n", rate_hz);
    auto all = compareEngines(plan);
    if (!all) return refuse(all.errors());
    if (all->interrupted) return printInterrupted();
    rates.push_back(std::move(*all));
  }
  if (auto done = writeResults(jsonText(allJson(rates)), comparisonPage(rates), *files); !done) {
    return refuse(done.errors());
  }
  for (const EngineComparison& at : rates) {
    print(at);
    printDistribution(at);
  }
  std::fputs(listed(*files).c_str(), stdout);
  return exitCodeOf(false, false);
}

}  // namespace wholehand
