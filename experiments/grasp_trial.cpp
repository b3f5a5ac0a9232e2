#include "experiments/grasp_trial.hpp"

#include "experiments/grasp_observer.hpp"
#include "experiments/grasp_script.hpp"
#include "files/text/text_file.hpp"
#include "loop/core/geometry.hpp"
#include "loop/runtime/interrupt_scope.hpp"
#include "rig/run/run.hpp"

#include <algorithm>
#include <cmath>
#include <random>
#include <utility>

namespace wholehand {
namespace {

GraspTrial posture(std::string shape, std::string grasp, const Eigen::Vector3d& center_mm,
                   double circ_deg, double open_deg, double fingers_deg, double thumb_deg) {
  return {std::move(shape), std::move(grasp),   false,           center_mm * 1e-3, circ_deg * kDeg,
          open_deg * kDeg,  fingers_deg * kDeg, thumb_deg * kDeg};
}

}  // namespace

std::string GraspTrial::name() const {
  return grasp + " " + shape + (gravity ? " under gravity" : " floating");
}

std::string GraspTrial::stem() const {
  std::string stem = name();
  std::replace(stem.begin(), stem.end(), ' ', '-');
  return stem;
}

std::vector<GraspTrial> tunedTrials() {
  const std::vector<GraspTrial> floating = {
      posture("cube", "power", {49, 7, -40}, 75, 20, 152, 75),
      posture("sphere", "power", {57, 6, -44}, 75, 20, 160, 80),
      posture("cylinder", "power", {49, 4, -41}, 65, 20, 155, 55),
      posture("disk", "power", {65, 8, -51}, 80, 20, 130, 75),
      posture("sphere", "pinch", {69, 11, -68}, 75, 40, 122, 75),
      posture("cube", "pinch", {69, 11, -68}, 75, 40, 170, 75)};
  std::vector<GraspTrial> trials;
  for (bool gravity : {false, true}) {
    for (GraspTrial trial : floating) {
      trial.gravity = gravity;
      trials.push_back(trial);
    }
  }
  return trials;
}

std::vector<GraspTrial> jitteredTrials(int count, std::uint64_t seed) {
  std::mt19937_64 random(seed);
  // Avoids std::uniform_real_distribution, whose values differ between standard libraries.
  const auto jitter = [&random](double half_width) {
    return half_width * (2.0 * static_cast<double>(random() >> 11U) * 0x1.0p-53 - 1.0);
  };
  const std::vector<GraspTrial> tuned = tunedTrials();
  std::vector<GraspTrial> trials;
  for (int i = 0; i < count; ++i) {
    GraspTrial trial = tuned[static_cast<std::size_t>(i) % tuned.size()];
    for (int axis = 0; axis < 3; ++axis) trial.center_m[axis] += jitter(3e-3);
    trial.circumduction_rad = std::min(trial.circumduction_rad + jitter(4 * kDeg), 90 * kDeg);
    trial.fingers_closed_rad = std::min(trial.fingers_closed_rad + jitter(6 * kDeg), 180 * kDeg);
    trial.thumb_closed_rad = std::min(trial.thumb_closed_rad + jitter(6 * kDeg), 80 * kDeg);
    trials.push_back(trial);
  }
  return trials;
}

Expected<Models> loadTrial(const GraspTrial& trial, ModelFiles files, const TrialSetup& setup) {
  auto models = loadModels(files);  // the scene depends on the hand
  if (!models) return models.errors();
  files.scene = setup.folder + "/" + trial.stem() + ".toml";
  if (auto written = writeText(files.scene, graspScene(trial, *models)); !written) {
    return written.errors();
  }
  models = loadModels(files);
  if (models && setup.adjust) setup.adjust(*models);
  return models;
}

Expected<GraspResult> runGrasp(const GraspTrial& trial, const ModelFiles& files,
                               const GraspPlan& plan) {
  const TrialSetup& setup = plan.setup;
  auto models = loadTrial(trial, files, setup);
  if (!models) return models.errors();
  Intention intention = graspIntention(trial, *models);
  auto rig = buildRig(std::move(*models), std::move(intention), setup.rig);
  if (!rig) return rig.errors();

  GraspObserver observer(trial, **rig, plan.hold_s);
  TickRecord last;
  const double end_s = grasp_times::kHoldBegins + plan.hold_s;
  RunPlan run;
  run.title = "Grasping: " + trial.name();
  run.duration_ticks = static_cast<std::uint64_t>(std::llround(end_s / setup.rig.period_s));
  run.simulated_clock = true;
  run.interrupts = &InterruptScope::shared();
  if (plan.record) run.record = setup.folder + "/" + trial.stem() + ".h5";
  run.sinks.emplace_back([&](const TickRecord& record) {
    observer(record);
    if (record.time_s < end_s) last = record;
  });
  auto outcome = runAndRecord(**rig, run);
  if (!outcome) return outcome.errors();
  GraspResult result = observer.finish(last);
  result.faulted = outcome->faulted;
  result.dropped = result.dropped || outcome->faulted;
  result.interrupted = outcome->interrupted;
  result.cpu_p50_us = outcome->summary.cpu.p50_ns / 1e3;
  result.cpu_p999_us = outcome->summary.cpu.p999_ns / 1e3;
  return result;
}

}  // namespace wholehand
