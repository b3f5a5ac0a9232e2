#include "apps/tools/experiment/experiment_command.hpp"
#include "apps/wholehand/run/run_summary.hpp"
#include "apps/wholehand/run/status_line.hpp"
#include "apps/wholehand/shared/exit_code.hpp"
#include "apps/wholehand/shared/result_files.hpp"
#include "apps/wholehand/shared/shipped_files.hpp"
#include "experiments/timing_trial.hpp"
#include "files/device/device_file.hpp"
#include "loop/core/printable.hpp"
#include "loop/realtime/allocation_counter.hpp"
#include "loop/runtime/interrupt_scope.hpp"

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include <algorithm>
#include <cstdio>

namespace wholehand {
namespace {

constexpr double kNoTick = 0.8;  // drawn for 0, which a logarithmic axis does not have

ChartMark percentileMark(const char* name, double time_ns) {
  const std::string us = fmt::format("{:.0f}", time_ns / 1e3);
  return {time_ns / 1e3, sentence("timing.mark", {{"name", name}, {"us", us}})};
}

std::vector<PageText> timesRow(const PageText& name, const Percentiles& p) {
  std::vector<PageText> row = {name};
  for (const double time_ns : {p.p50_ns, p.p99_ns, p.p999_ns, p.max_ns}) {
    row.push_back(fmt::format("{:.1f}", time_ns / 1e3));
  }
  return row;
}

ChartPage timePage(const TimingResult& r) {
  const TickSummary& s = r.outcome.summary;
  Chart chart;
  chart.title = sentence("timing.chart");
  chart.height_px = 300;
  chart.x = {"µs", 0.0, kTimingBin_us * kTimingBins};
  chart.y.logarithmic = true;
  ChartLine counts{nullptr, "--ax-z"};
  counts.stepped = counts.filled = true;
  for (std::size_t i = 0; i < r.wall_counts.size(); ++i) {
    const auto count = static_cast<double>(r.wall_counts[i]);
    counts.points.push_back({kTimingBin_us * static_cast<double>(i), std::max(count, kNoTick)});
    chart.y.to = std::max(chart.y.to >= 0.0 ? chart.y.to : 10.0, 2.0 * count);
  }
  chart.y.from = kNoTick;
  chart.lines = {std::move(counts)};
  chart.marks = {percentileMark("p50", s.wall.p50_ns),
                 percentileMark("p99.9", s.wall.p999_ns),
                 {1000.0, sentence("timing.deadline"), true}};
  ChartTable table{
      sentence("timing.table"),
      {sentence("timing.what"), "p50", "p99", "p99.9", sentence("timing.most")},
      {timesRow(sentence("timing.cpu"), s.cpu), timesRow(sentence("timing.held"), r.held_cpu),
       timesRow(sentence("timing.wall"), s.wall)}};
  for (int i = 0; i < kStages; ++i) {
    const char* name = stageName(static_cast<Stage>(i));
    table.rows.push_back(timesRow(sentence("stage", {{"stage", name}}), s.stage_cpu[i]));
  }
  ChartPage page;
  page.title = sentence("timing.title", {{"ticks", std::to_string(s.records)}});
  page.charts = {std::move(chart)};
  page.tables = {std::move(table)};
  return page;
}

double share(std::uint64_t part, std::uint64_t whole) {
  return whole > 0 ? static_cast<double>(part) / static_cast<double>(whole) : 0.0;
}

nlohmann::ordered_json timingJson(const TimingResult& r) {
  const TickSummary& s = r.outcome.summary;
  nlohmann::ordered_json json;
  json["engine"] = r.outcome.engine;
  json["gripped"] = r.gripped;
  json["ticks"] = s.ticks;
  json["missed_deadlines"] = s.missed_deadlines;
  json["allocations"] = r.outcome.counters.allocations;
  json["allocations_counted"] = allocationCountingAvailable();
  json["cpu_us"] = microseconds(s.cpu);
  json["held_cpu_us"] = microseconds(r.held_cpu);
  json["wall_us"] = microseconds(s.wall);
  for (int i = 0; i < kStages; ++i) {
    json["stages_cpu_us"][stageName(static_cast<Stage>(i))] = microseconds(s.stage_cpu[i]);
  }
  json["lateness_us"] = microseconds(s.lateness);
  json["grasps"] = r.grasps;
  json["releases"] = r.releases;
  json["held_share"] = share(r.held_ticks, s.records);
  json["walls_share"] = share(r.wall_ticks, s.records);
  json["joint_travel"] = r.joint_travel;
  json["max_coupling_error_rad"] = s.max_coupling_error_rad;
  return json;
}

void print(const TimingResult& r) {
  const TickSummary& s = r.outcome.summary;
  std::printf(
      "%llu ticks, %llu deadline%s missed, %llu allocation%s in the tick, %d grasp%s, %d "
      "release%s\n",
      static_cast<unsigned long long>(s.ticks), static_cast<unsigned long long>(s.missed_deadlines),
      plural(s.missed_deadlines), static_cast<unsigned long long>(r.outcome.counters.allocations),
      plural(r.outcome.counters.allocations), r.grasps, plural(r.grasps), r.releases,
      plural(r.releases));
  std::printf("%s gripped in %.0f %% of the ticks, the exercise's walls felt in %.0f %%\n",
              r.gripped.c_str(), 100.0 * share(r.held_ticks, s.records),
              100.0 * share(r.wall_ticks, s.records));
  std::printf("%-16s %9s %9s %9s %9s\n", "µs", "p50", "p99", "p99.9", "max");
  const auto row = [](const char* name, const Percentiles& p) {
    std::printf("%-16s %9.1f %9.1f %9.1f %9.1f\n", name, p.p50_ns / 1e3, p.p99_ns / 1e3,
                p.p999_ns / 1e3, p.max_ns / 1e3);
  };
  row("tick, CPU", s.cpu);
  row("while gripped", r.held_cpu);
  row("tick, wall", s.wall);
  for (int i = 0; i < kStages; ++i) {
    row(stageName(static_cast<Stage>(i)), s.stage_cpu[i]);
  }
  for (const SetupLine& line : r.outcome.setup) {
    if (!line.granted) std::printf("machine: %s: %s\n", line.what.c_str(), line.sentence.c_str());
  }
}

ModelFiles filesFor(const ExperimentOptions& options) {
  ModelFiles files = shippedModels();
  files.scene = options.scene;  // replaces the scene that the exercise names
  if (options.scene.empty()) files.exercise = exerciseFile("cocktail-bar");
  return files;
}

}  // namespace

int timingCommand(const ExperimentOptions& options) {
  const auto files = prepareResults(options.folder, options.json, "timing");
  if (!files) return refuse(files.errors());
  TimingPlan plan;
  plan.files = filesFor(options);
  plan.engine = options.engine;
  auto device = loadDeviceFile(plan.files.device);
  if (!device) return refuse(device.errors());
  StatusLine status(*device);
  plan.ticks = options.ticks;
  plan.simulated_clock = options.simulated_clock;
  plan.folder = options.folder;
  plan.count_allocations = &threadAllocations;
  plan.status = [&](const TickSummary& now, double rate_hz) { status.update(now, rate_hz); };
  const InterruptScope interrupts;
  auto result = runTiming(plan);
  status.finish();
  if (!result) return refuse(result.errors());
  if (auto done = writeResults(jsonText(timingJson(*result)), timePage(*result), *files); !done) {
    return refuse(done.errors());
  }
  print(*result);
  std::printf("%s%s/timing.h5\n", listed(*files).c_str(), printable(options.folder).c_str());
  return exitCodeOf(result->outcome.faulted, result->outcome.interrupted);
}

}  // namespace wholehand
