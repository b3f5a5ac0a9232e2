#include "apps/tools/experiment/experiment_command.hpp"
#include "apps/wholehand/shared/exit_code.hpp"
#include "apps/wholehand/shared/result_files.hpp"
#include "apps/wholehand/shared/shipped_files.hpp"
#include "experiments/complexity_trial.hpp"
#include "loop/core/printable.hpp"
#include "loop/runtime/interrupt_scope.hpp"

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdio>
#include <string>

namespace wholehand {
namespace {

double limitAt(double rate_hz) {
  return 0.5e6 / rate_hz;
}

/// Text of the admitted count: "87"; ">= 120" if the largest measured count is admitted; "none".
std::string admittedText(const ComplexityCurve& curve, double rate_hz) {
  bool all = false;
  const double count = curve.admitted(limitAt(rate_hz), all);
  if (count < 0.0) return "-";
  return fmt::format("{}{:.0f}", all ? "≥ " : "", count);
}

nlohmann::ordered_json pointJson(const ComplexityPoint& p) {
  return {{"count", p.count},       {"bodies", p.bodies},
          {"contacts", p.contacts}, {"contacts_dropped", p.dropped},
          {"faulted", p.faulted},   {"p10_us", p.p10_us},
          {"p50_us", p.p50_us},     {"p99_us", p.p99_us},
          {"p999_us", p.p999_us},   {"p999_once_us", p.p999_once_us}};
}

nlohmann::ordered_json complexityJson(const ComplexityResult& result, const ComplexityPlan& plan) {
  nlohmann::ordered_json json;
  json["engine"] = plan.engine;
  json["ticks"] = plan.ticks;
  json["passes"] = plan.passes;
  json["curves"] = nlohmann::ordered_json::array();
  for (const ComplexityCurve& curve : result.curves) {
    nlohmann::ordered_json one;
    one["of"] = complexityName(curve.kind);
    const double exponent = curve.exponent();
    one["exponent"] = std::isfinite(exponent) ? nlohmann::ordered_json(exponent) : nullptr;
    one["largest_over_none"] = curve.points.back().p50_us / curve.points.front().p50_us;
    for (const double rate_hz : kComplexityRatesHz) {
      bool all = false;
      const double count = curve.admitted(limitAt(rate_hz), all);
      one["admitted"].push_back({{"rate_hz", rate_hz}, {"count", count}, {"at_least", all}});
    }
    for (const ComplexityPoint& p : curve.points) one["points"].push_back(pointJson(p));
    json["curves"].push_back(std::move(one));
  }
  return json;
}

std::string nameOf(const ComplexityCurve& curve, const char* part) {
  return fmt::format("complexity.{}.{}", part, complexityName(curve.kind));
}

/// Chart of median and p99.9 over the count, with the limits of the rates.
Chart curveChart(const ComplexityCurve& curve) {
  constexpr double kLeast_us = 5.0;
  Chart chart;
  chart.title = sentence(nameOf(curve, "chart").c_str());
  chart.height_px = 180;
  ChartLine median{sentence("complexity.median"), "--ax-x"};
  ChartLine slow{sentence("complexity.slow"), "--ax-z"};
  ChartLine dots{nullptr, "--ax-z"};
  dots.dot_px = 4;
  double most_us = limitAt(kComplexityRatesHz.front());
  for (const ComplexityPoint& p : curve.points) {
    median.points.push_back({static_cast<double>(p.count), p.p50_us});
    slow.points.push_back({static_cast<double>(p.count), p.p999_us});
    dots.points.push_back({static_cast<double>(p.count), p.p999_us});
    most_us = std::max(most_us, p.p999_us);
  }
  const double most = curve.points.back().count;
  chart.x = {"", 0.0, most};
  chart.y = {"µs", kLeast_us, 1.2 * most_us, true};
  chart.lines = {median, slow, dots};
  for (const double rate_hz : kComplexityRatesHz) {
    ChartLine limit{nullptr, "--ink-2", {4, 4}, 1.0};
    limit.points = {{0.0, limitAt(rate_hz)}, {most, limitAt(rate_hz)}};
    chart.lines.push_back(limit);
  }
  return chart;
}

ChartTable admittedTable(const ComplexityResult& result) {
  ChartTable table;
  table.title = sentence("complexity.admitted");
  table.heads = {sentence("timing.what")};
  for (const double rate_hz : kComplexityRatesHz) {
    table.heads.emplace_back(fmt::format("{:.0f} kHz", rate_hz * 1e-3));
  }
  for (const ComplexityCurve& curve : result.curves) {
    std::vector<PageText> row{sentence(nameOf(curve, "of").c_str())};
    for (const double rate_hz : kComplexityRatesHz) {
      row.emplace_back(admittedText(curve, rate_hz));
    }
    table.rows.push_back(std::move(row));
  }
  return table;
}

ChartTable timesTable(const ComplexityCurve& curve) {
  ChartTable table;
  table.title = sentence(nameOf(curve, "chart").c_str());
  table.heads = {sentence("complexity.count"), "p50, µs", "p99, µs", "p99.9, µs",
                 sentence("complexity.contacts")};
  for (const ComplexityPoint& p : curve.points) {
    table.rows.push_back({std::to_string(p.count), fmt::format("{:.1f}", p.p50_us),
                          fmt::format("{:.1f}", p.p99_us), fmt::format("{:.1f}", p.p999_us),
                          std::to_string(p.contacts)});
  }
  return table;
}

ChartPage complexityPage(const ComplexityResult& result, const ComplexityPlan& plan) {
  ChartPage page;
  page.title = sentence("complexity.title");
  page.notes = {sentence("complexity.note",
                         {{"engine", plan.engine}, {"passes", std::to_string(plan.passes)}})};
  page.columns = 2;
  for (const ComplexityCurve& curve : result.curves) page.charts.push_back(curveChart(curve));
  page.tables.push_back(admittedTable(result));
  for (const ComplexityCurve& curve : result.curves) page.tables.push_back(timesTable(curve));
  return page;
}

const char* headOf(ComplexityKind kind) {
  constexpr std::array<const char*, kComplexityKinds> kHeads = {
      "balls in a pile, the hand in it",
      "boxes in stacks of four, the hand on them",
      "boxes resting apart, below the hand",
      "boxes resting out of the hand's reach",
      "corners of a mesh that the hand presses upon",
      "fixed balls that the hand lies on"};
  static_assert(kHeads.back() != nullptr, "a head for each kind");
  return kHeads.at(static_cast<std::size_t>(kind));
}

void print(const ComplexityCurve& curve) {
  std::printf("\n%s\n%8s %8s %9s %8s %9s %9s %10s\n", headOf(curve.kind), "count", "bodies",
              "contacts", "p50 µs", "p99 µs", "p99.9 µs", "p99.9 once");
  for (const ComplexityPoint& p : curve.points) {
    std::printf("%8d %8d %9d %7.1f %8.1f %8.1f %10.1f%s\n", p.count, p.bodies, p.contacts, p.p50_us,
                p.p99_us, p.p999_us, p.p999_once_us, p.faulted ? "  a fault stopped it" : "");
    if (p.dropped > 0)
      std::printf("%8s %d contact points more than a record holds\n", "", p.dropped);
  }
  const ComplexityPoint &first = curve.points.front(), &last = curve.points.back();
  std::printf("  largest over smallest, p50: %.2f", last.p50_us / first.p50_us);
  if (const double e = curve.exponent(); std::isfinite(e)) {
    std::printf("; what n add to the median of none grows as n^%.2f", e);
  }
  std::printf("\n  admitted at");
  for (const double rate_hz : kComplexityRatesHz) {
    std::printf(" %.0f kHz: %s%s", rate_hz * 1e-3, admittedText(curve, rate_hz).c_str(),
                rate_hz < kComplexityRatesHz.back() ? "," : "\n");
  }
}

ComplexityPlan complexityPlan(const ExperimentOptions& options) {
  ComplexityPlan plan;
  plan.engine = options.engine;
  plan.only = options.only;
  plan.ticks = options.scene_ticks;
  plan.passes = options.passes;
  plan.files = shippedModels();
  plan.files.scene = shippedFile("config/scenes/empty.toml");
  plan.status = [](int pass, int passes) {
    std::printf("pass %d of %d\n", pass, passes);
    std::fflush(stdout);
  };
  return plan;
}

}  // namespace

int complexityCommand(const ExperimentOptions& options) {
  const InterruptScope interrupts;
  const auto files = prepareResults(options.folder, options.json, "complexity");
  if (!files) return refuse(files.errors());
  const ComplexityPlan plan = complexityPlan(options);
  auto result = measureComplexity(plan);
  if (!result) return refuse(result.errors());
  if (result->interrupted) return printInterrupted();
  if (auto done = writeResults(jsonText(complexityJson(*result, plan)),
                               complexityPage(*result, plan), *files);
      !done) {
    return refuse(done.errors());
  }
  std::printf(
      "CPU time of whole ticks; each tick's shortest of %d runs to the same bits.\n"
      "Admitted: p99.9 takes at most half of the period.\n",
      plan.passes);
  for (const ComplexityCurve& curve : result->curves) print(curve);
  std::printf("\n%s", listed(*files).c_str());
  return exitCodeOf(false, false);
}

}  // namespace wholehand
