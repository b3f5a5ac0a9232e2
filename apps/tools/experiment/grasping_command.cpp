#include "apps/tools/experiment/experiment_command.hpp"
#include "apps/wholehand/shared/exit_code.hpp"
#include "apps/wholehand/shared/result_files.hpp"
#include "apps/wholehand/shared/shipped_files.hpp"
#include "experiments/grasp_trial.hpp"
#include "loop/core/printable.hpp"
#include "loop/runtime/interrupt_scope.hpp"
#include "rig/run/run.hpp"

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include <algorithm>
#include <cstdio>

namespace wholehand {
namespace {

constexpr double kSlipAsked_m = 1e-4;
constexpr double kLeastSlip_mm = 1e-4, kMostSlip_mm = 100.0;  // range of the chart

nlohmann::ordered_json trialJson(const GraspResult& r) {
  return {{"shape", r.trial.shape},
          {"grasp", r.trial.grasp},
          {"gravity", r.trial.gravity},
          {"dropped", r.dropped},
          {"faulted", r.faulted},
          {"slip_m", r.slip_m},
          {"carry_shift_m", r.carry_shift_m},
          {"coupling_error_rad", r.coupling_error_rad},
          {"object_travel_m", r.object_travel_m},
          {"force_noise_n", r.force_noise_n},
          {"rotation_rad", r.rotation_rad},
          {"contact_residual", r.contact_residual},
          {"contact_force_n", r.contact_force_n},
          {"tip_force_max_n", r.tip_force_max_n},
          {"saturated_ticks", r.saturated_ticks},
          {"cpu_us", {{"p50", r.cpu_p50_us}, {"p999", r.cpu_p999_us}}}};
}

void printTrialHeader() {
  std::printf("%-32s %-7s %9s %9s %9s %10s %9s %8s %8s\n", "trial", "held", "shift mm", "slip mm",
              "turn mrad", "noise N", "grip N", "tip N", "tick µs");
}

void printTrial(const GraspResult& r) {
  std::printf("%-32s %-7s %9.2f %9.3f %9.2f %10.4f %9.1f %8.1f %8.0f\n", r.trial.name().c_str(),
              r.faulted ? "FAULT" : (r.dropped ? "DROPPED" : "yes"), r.carry_shift_m * 1e3,
              r.slip_m * 1e3, r.rotation_rad * 1e3, r.force_noise_n, r.contact_force_n,
              r.tip_force_max_n, r.cpu_p50_us);
  std::fflush(stdout);
}

/// Cumulative distribution of slip.
ChartLine slipLine(const char* name, const char* color, std::vector<int> dash_px,
                   const std::vector<GraspResult>& results) {
  std::vector<double> slips_mm;
  for (const GraspResult& r : results) {
    slips_mm.push_back(std::clamp(r.slip_m * 1e3, kLeastSlip_mm, kMostSlip_mm));
  }
  std::sort(slips_mm.begin(), slips_mm.end());
  ChartLine line{sentence(name), color, std::move(dash_px)};
  line.stepped = true;
  line.points = {{kLeastSlip_mm, 0.0}};
  for (std::size_t i = 0; i < slips_mm.size(); ++i) {
    line.points.push_back(
        {slips_mm[i], static_cast<double>(i + 1) / static_cast<double>(slips_mm.size())});
  }
  line.points.push_back({kMostSlip_mm, 1.0});
  return line;
}

ChartPage slipPage(const std::vector<GraspResult>& tuned,
                   const std::vector<GraspResult>& jittered) {
  Chart chart;
  chart.title = sentence("grasping.chart");
  chart.height_px = 260;
  chart.x = {"mm", kLeastSlip_mm, kMostSlip_mm, true};
  chart.y = {"", 0.0, 1.15, false, {0.0, 0.25, 0.5, 0.75, 1.0}};
  chart.marks = {{kSlipAsked_m * 1e3, sentence("grasping.asked")}};
  if (!tuned.empty()) chart.lines.push_back(slipLine("grasping.tuned", "--ax-t", {}, tuned));
  if (!jittered.empty()) {
    chart.lines.push_back(slipLine("grasping.jittered", "--ax-f", {6, 3}, jittered));
  }
  ChartPage page;
  page.title = sentence("grasping.title");
  page.charts = {std::move(chart)};
  return page;
}

struct Sweep {
  std::vector<GraspResult> results;
  Diagnostics errors;
  bool interrupted = false;
  [[nodiscard]] auto faulted() const {
    return std::count_if(results.begin(), results.end(),
                         [](const GraspResult& r) { return r.faulted; });
  }
};

std::vector<GraspTrial> onlyThose(const std::vector<GraspTrial>& trials, const std::string& part) {
  std::vector<GraspTrial> chosen;
  for (const GraspTrial& trial : trials) {
    if (trial.name().find(part) != std::string::npos) chosen.push_back(trial);
  }
  return chosen;
}

// The requested number of jittered trials. Chosen trials are repeated in the order of the tuned
// trials.
std::vector<GraspTrial> chosenJitter(const ExperimentOptions& options) {
  const int rounds = options.only.empty() ? 1 : static_cast<int>(tunedTrials().size());
  auto chosen = onlyThose(jitteredTrials(options.jittered * rounds, options.seed), options.only);
  chosen.resize(std::min(chosen.size(), static_cast<std::size_t>(options.jittered)));
  return chosen;
}

Diagnostic unknownTrial(const std::string& part) {
  std::string names;
  for (const GraspTrial& trial : tunedTrials()) {
    names += (names.empty() ? "" : ", ") + trial.name();
  }
  return {"", 0, "--only", part, "is part of no trial's name", "the trials are " + names};
}

Sweep runAll(const std::vector<GraspTrial>& trials, const ExperimentOptions& options,
             bool keep_recordings) {
  Sweep sweep;
  for (const GraspTrial& trial : trials) {
    GraspPlan plan;
    plan.setup.folder = options.folder;
    plan.setup.rig.engine = options.engine;
    plan.record = keep_recordings;
    auto result = runGrasp(trial, shippedModels(), plan);
    if (!result) {
      sweep.errors = result.errors();
      return sweep;
    }
    if (result->interrupted || InterruptScope::interrupted()) {
      sweep.interrupted = true;
      return sweep;
    }
    sweep.results.push_back(*result);
    if (!keep_recordings)
      std::printf("%3zu ", sweep.results.size());  // numbers, because names repeat
    printTrial(*result);
  }
  return sweep;
}

}  // namespace

int graspingCommand(const ExperimentOptions& options) {
  const InterruptScope interrupts;  // Ctrl-C also works between trials
  const std::vector<GraspTrial> trials = onlyThose(tunedTrials(), options.only);
  if (trials.empty()) return refuse({unknownTrial(options.only)});
  const auto files = prepareResults(options.folder, options.json, "grasping");
  if (!files) return refuse(files.errors());
  std::printf("Grasp, carry 20 cm, hold 10 s; postures tuned, without and with gravity\n");
  printTrialHeader();
  // Tuned trials, then trials with jitter.
  const Sweep tuned = runAll(trials, options, true);
  if (!tuned.errors.empty()) return refuse(tuned.errors);
  if (tuned.interrupted) return printInterrupted();
  if (options.jittered > 0) {
    std::printf("\n%d trial%s with jittered positions and commands, seed %llu\n    ",
                options.jittered, plural(options.jittered),
                static_cast<unsigned long long>(options.seed));
    printTrialHeader();
  }
  const Sweep jittered = runAll(chosenJitter(options), options, false);
  if (!jittered.errors.empty()) return refuse(jittered.errors);
  if (jittered.interrupted) return printInterrupted();

  nlohmann::ordered_json json;
  json["engine"] = options.engine;
  json["trials"] = nlohmann::ordered_json::array();
  for (const GraspResult& r : tuned.results) json["trials"].push_back(trialJson(r));
  // Statistics of the jittered trials.
  int dropped = 0, slipped = 0;
  double noise = 0.0;
  nlohmann::ordered_json each = nlohmann::ordered_json::array();
  for (const GraspResult& r : jittered.results) {
    dropped += r.dropped ? 1 : 0;
    slipped += r.slip_m > kSlipAsked_m ? 1 : 0;
    noise = std::max(noise, r.force_noise_n);
    each.push_back(trialJson(r));
  }
  json["jittered"] = {
      {"trials", jittered.results.size()}, {"dropped", dropped},   {"slip_over_tenth_mm", slipped},
      {"force_noise_max_n", noise},        {"seed", options.seed}, {"each", each}};
  const ChartPage charts = slipPage(tuned.results, jittered.results);
  if (auto done = writeResults(jsonText(json), charts, *files); !done) {
    return refuse(done.errors());
  }
  std::printf("\n");
  if (!jittered.results.empty()) {
    std::printf("jittered: %zu trial%s, %d dropped, %d slipped over 0.1 mm, noise at most %.4f N\n",
                jittered.results.size(), plural(jittered.results.size()), dropped, slipped, noise);
  }
  std::printf("%srecordings and scenes in %s\n", listed(*files).c_str(),
              printable(options.folder).c_str());
  const auto faulted = tuned.faulted() + jittered.faulted();
  if (faulted > 0) std::printf("FAULT    trials stopped by a fault: %td\n", faulted);
  return exitCodeOf(faulted > 0, false);
}

}  // namespace wholehand
