#include "assembly/run.hpp"
#include "assembly/text_file.hpp"
#include "core/plural.hpp"
#include "exit_code.hpp"
#include "experiment_command.hpp"
#include "experiments/grasp_trial.hpp"
#include "report/svg_plot.hpp"
#include "runtime/interrupt_scope.hpp"
#include "shipped_files.hpp"

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include <algorithm>
#include <cstdio>

namespace wholehand {
namespace {

constexpr double kSlipAsked_m = 0.5e-3;

ModelFiles shippedModels() {
  ModelFiles files;
  for (std::string* file :
       {&files.scene, &files.hand, &files.device, &files.rendering, &files.patient}) {
    *file = shippedFile(*file);
  }
  return files;
}

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

void printHeader() {
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

// Slip of all trials, sorted, on a logarithmic axis: how many stay below what is asked.
std::string slipPlot(const std::vector<GraspResult>& tuned,
                     const std::vector<GraspResult>& jittered) {
  LinePlot plot;
  plot.title = "Slip during a 10 s hold, mm: share of the trials that slip no further";
  plot.width_px = 760;
  plot.height_px = 260;
  plot.log_x = true;
  plot.x_min = 1e-4;
  plot.x_max = 100.0;
  plot.y_min = 0.0;
  plot.y_max = 1.0;
  plot.x_unit = "mm";
  plot.marks = {{kSlipAsked_m * 1e3, "asked: 0.5 mm"}};
  const auto line = [](const char* name, const char* color, const char* dash,
                       const std::vector<GraspResult>& results) {
    std::vector<double> slips;
    for (const GraspResult& r : results) slips.push_back(std::max(r.slip_m * 1e3, 1e-4));
    std::sort(slips.begin(), slips.end());
    PlotLine out;
    out.name = name;
    out.color = color;
    out.dash = dash;
    out.points.push_back({1e-4, 0.0});
    for (std::size_t i = 0; i < slips.size(); ++i) {
      const double n = static_cast<double>(slips.size());
      out.points.push_back({slips[i], static_cast<double>(i) / n});
      out.points.push_back({slips[i], static_cast<double>(i + 1) / n});
    }
    out.points.push_back({100.0, 1.0});
    return out;
  };
  if (!tuned.empty()) plot.lines.push_back(line("tuned", "#006A94", "", tuned));
  if (!jittered.empty()) plot.lines.push_back(line("jittered", "#8A5A00", "6 3", jittered));
  return linePlot(plot);
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

// As many jittered trials as asked for, of the chosen ones: they come round in the tuned ones'
// order.
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
    plan.folder = options.folder;
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
    if (!keep_recordings) std::printf("%3zu ", sweep.results.size());  // they share their names
    printTrial(*result);
  }
  return sweep;
}

int interrupted() {
  std::printf("\nInterrupted: no results were written\n");
  return kExitInterrupted;
}

}  // namespace

int graspingCommand(const ExperimentOptions& options) {
  const InterruptScope interrupts;  // also between trials
  const std::vector<GraspTrial> trials = onlyThose(tunedTrials(), options.only);
  if (trials.empty()) return refuse({unknownTrial(options.only)});
  const std::string json_path =
      options.json.empty() ? options.folder + "/grasping.json" : options.json;
  if (auto ready = prepareFiles({options.folder + "/grasping.svg", json_path}); !ready) {
    return refuse(ready.errors());
  }
  std::printf("Grasp, carry 20 cm, hold 10 s; postures tuned, without and with gravity\n");
  printHeader();
  const Sweep tuned = runAll(trials, options, true);
  if (!tuned.errors.empty()) return refuse(tuned.errors);
  if (tuned.interrupted) return interrupted();
  if (options.jittered > 0) {
    std::printf("\n%d trial%s with jittered positions and commands, seed %llu\n    ",
                options.jittered, plural(options.jittered),
                static_cast<unsigned long long>(options.seed));
    printHeader();
  }
  const Sweep jittered = runAll(chosenJitter(options), options, false);
  if (!jittered.errors.empty()) return refuse(jittered.errors);
  if (jittered.interrupted) return interrupted();

  nlohmann::ordered_json json;
  json["trials"] = nlohmann::ordered_json::array();
  for (const GraspResult& r : tuned.results) json["trials"].push_back(trialJson(r));
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
      {"trials", jittered.results.size()}, {"dropped", dropped},   {"slip_over_half_mm", slipped},
      {"force_noise_max_n", noise},        {"seed", options.seed}, {"each", each}};
  if (auto done = writeText(json_path, json.dump(2) + "\n"); !done) return refuse(done.errors());
  const std::string plot = options.folder + "/grasping.svg";
  if (auto done = writeText(plot, slipPlot(tuned.results, jittered.results)); !done) {
    return refuse(done.errors());
  }
  std::printf("\n");
  if (!jittered.results.empty()) {
    std::printf("jittered: %zu trial%s, %d dropped, %d slipped over 0.5 mm, noise at most %.4f N\n",
                jittered.results.size(), plural(jittered.results.size()), dropped, slipped, noise);
  }
  std::printf("%s\n%s\nrecordings and scenes in %s\n", json_path.c_str(), plot.c_str(),
              options.folder.c_str());
  const auto faulted = tuned.faulted() + jittered.faulted();
  if (faulted > 0) std::printf("FAULT    trials stopped by a fault: %td\n", faulted);
  return endOf(faulted > 0, false);
}

}  // namespace wholehand
