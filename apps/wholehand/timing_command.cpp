#include "assembly/text_file.hpp"
#include "core/plural.hpp"
#include "exit_code.hpp"
#include "experiment_command.hpp"
#include "experiments/timing_trial.hpp"
#include "realtime/allocation_counter.hpp"
#include "report/svg_plot.hpp"
#include "runtime/interrupt_scope.hpp"
#include "shipped_files.hpp"
#include "status_line.hpp"
#include "summary_json.hpp"

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include <algorithm>
#include <cstdio>

namespace wholehand {
namespace {

std::string timePlot(const std::vector<std::uint64_t>& counts, const Percentiles& p,
                     const std::string& title) {
  HistogramPlot plot;
  plot.title = title;
  plot.width_px = 760;
  plot.height_px = 300;
  plot.x_min = 0.0;
  plot.x_max = kTimingBin_us * kTimingBins;
  plot.counts = counts;
  plot.x_unit = "µs";
  plot.marks = {{p.p50_ns / 1e3, fmt::format("p50 {:.0f} µs", p.p50_ns / 1e3)},
                {p.p999_ns / 1e3, fmt::format("p99.9 {:.0f} µs", p.p999_ns / 1e3)}};
  plot.deadline = 1000.0;
  plot.deadline_label = "deadline 1 ms";
  return histogramPlot(plot);
}

double share(std::uint64_t part, std::uint64_t whole) {
  return whole > 0 ? static_cast<double>(part) / static_cast<double>(whole) : 0.0;
}

nlohmann::ordered_json timingJson(const TimingResult& r) {
  const TickSummary& s = r.outcome.summary;
  nlohmann::ordered_json json;
  json["gripped"] = r.gripped;
  json["ticks"] = s.ticks;
  json["missed_deadlines"] = s.missed_deadlines;
  json["allocations"] = r.outcome.counters.allocations;
  json["allocations_counted"] = allocationCountingAvailable();
  json["cpu_us"] = microseconds(s.cpu);
  json["wall_us"] = microseconds(s.wall);
  for (int i = 0; i < kStages; ++i) {
    json["stages_cpu_us"][stageName(static_cast<Stage>(i))] =
        microseconds(s.stage_cpu[static_cast<std::size_t>(i)]);
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
  row("tick, wall", s.wall);
  for (int i = 0; i < kStages; ++i) {
    row(stageName(static_cast<Stage>(i)), s.stage_cpu[static_cast<std::size_t>(i)]);
  }
  for (const SetupLine& line : r.outcome.setup) {
    if (!line.granted) std::printf("machine: %s: %s\n", line.what.c_str(), line.sentence.c_str());
  }
}

ModelFiles filesFor(const ExperimentOptions& options) {
  ModelFiles files;
  for (std::string* file : {&files.hand, &files.device, &files.rendering, &files.patient}) {
    *file = shippedFile(*file);
  }
  files.scene = options.scene;  // an exercise names it
  if (options.scene.empty()) files.exercise = exerciseFile("cocktail-bar");
  return files;
}

}  // namespace

int timingCommand(const ExperimentOptions& options) {
  const std::string json_path =
      options.json.empty() ? options.folder + "/timing.json" : options.json;
  if (auto ready = prepareFiles({options.folder + "/timing.svg", json_path}); !ready) {
    return refuse(ready.errors());
  }
  TimingPlan plan;
  plan.files = filesFor(options);
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
  if (auto done = writeText(json_path, timingJson(*result).dump(2) + "\n"); !done) {
    return refuse(done.errors());
  }
  const std::string plot = options.folder + "/timing.svg";
  const std::string title =
      fmt::format("Time per tick on the wall clock, {} ticks", result->outcome.summary.records);
  if (auto done =
          writeText(plot, timePlot(result->wall_counts, result->outcome.summary.wall, title));
      !done) {
    return refuse(done.errors());
  }
  print(*result);
  std::printf("%s\n%s\n%s/timing.h5\n", json_path.c_str(), plot.c_str(), options.folder.c_str());
  return endOf(result->outcome.faulted, result->outcome.interrupted);
}

}  // namespace wholehand
