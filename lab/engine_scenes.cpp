#include "lab/engine_scenes.hpp"

#include "experiments/grasp_script.hpp"
#include "files/text/text_file.hpp"

#include <algorithm>
#include <cmath>
#include <utility>
#include <vector>

namespace wholehand {
namespace {

/// The hand rests above the table without any contact.
Intention clearOfTheTable(const DeviceModel& device) {
  AxisPosition q(device.axisCount());
  if (const int x = device.axisIndex("x"); x >= 0) q[x] = -0.08;
  if (const int z = device.axisIndex("z"); z >= 0) q[z] = 0.11;
  return Intention::throughWaypoints({{0.0, q}});
}

/// After closing, the hand never rests: every axis swings about the grip with its own period, so
/// that the grip tightens, loosens and slides.
Intention restlessGrip(const Models& models, double end_s) {
  constexpr double kSwing_s = 0.4, kShift_m = 0.02, kBend_rad = 0.12;
  const Intention grasp = graspIntention(comparedGrasp(), models);
  std::vector<Waypoint> way;
  AxisPosition q;
  AxisVelocity qd;
  for (const double at_s : {0.0, grasp_times::kApproached, grasp_times::kOpposed}) {
    grasp.evaluate(at_s, q, qd);
    way.push_back({at_s, q});
  }
  grasp.evaluate(grasp_times::kClosed, q, qd);
  const AxisPosition closed = q;
  double at_s = grasp_times::kClosed;
  for (int swing = 0; at_s < end_s + kSwing_s; ++swing, at_s += kSwing_s) {
    for (int a = 0; a < q.size(); ++a) {
      const DeviceAxis& axis = models.device.axes[a];
      const double size = axis.kind == AxisKind::kTranslation ? kShift_m : kBend_rad;
      q[a] =
          std::clamp(closed[a] + size * std::sin(swing * (1.0 + 0.3 * a)), axis.lower, axis.upper);
    }
    way.push_back({at_s, q});
  }
  return Intention::throughWaypoints(std::move(way));
}

Expected<Models> graspModels(EngineScene scene, const EnginePlan& plan) {
  auto models = loadModels(plan.files);
  if (!models) return models.errors();
  ModelFiles files = plan.files;
  files.scene = plan.folder + "/engines.toml";
  if (auto written = writeText(files.scene, graspScene(comparedGrasp(), *models)); !written) {
    return written.errors();
  }
  models = loadModels(files);
  if (!models) return models.errors();
  if (scene == EngineScene::kFree) models->scene.bodies.clear();
  if (scene == EngineScene::kFixed) {
    SceneBody& cylinder = models->scene.bodies.front();
    cylinder.fixed = true;
    cylinder.mass_kg = 0.0;
    cylinder.inertia_kg_m2.setZero();
  }
  return models;
}

Intention intentionOf(EngineScene scene, const EnginePlan& plan, const Models& models) {
  if (scene == EngineScene::kResting) return clearOfTheTable(models.device);
  if (scene != EngineScene::kGripped) return graspIntention(comparedGrasp(), models);
  return restlessGrip(models, static_cast<double>(plan.gripped_ticks) / plan.rate_hz);
}

}  // namespace

const char* engineSceneName(EngineScene scene) {
  constexpr std::array<const char*, kEngineScenes> kNames{"free", "fixed", "held", "resting",
                                                          "gripped"};
  return kNames.at(static_cast<std::size_t>(scene));
}

GraspTrial comparedGrasp() {
  for (const GraspTrial& trial : tunedTrials()) {
    if (trial.shape == "cylinder" && !trial.gravity) return trial;
  }
  return {};
}

std::uint64_t ticksOf(EngineScene scene, const EnginePlan& plan) {
  if (scene == EngineScene::kGripped) return plan.gripped_ticks;
  // Free and fixed: the hand is closed and does not lift yet.
  double end_s = grasp_times::kLiftBegins;
  if (scene == EngineScene::kHeld) end_s = grasp_times::kHoldBegins + plan.hold_s;
  if (scene == EngineScene::kResting) end_s = plan.hold_s;
  return static_cast<std::uint64_t>(std::llround(end_s * plan.rate_hz));
}

Expected<std::unique_ptr<Rig>> buildScene(EngineScene scene, const EnginePlan& plan,
                                          const std::string& engine) {
  ModelFiles resting = plan.files;
  resting.scene = plan.resting_file;
  const bool rests = scene == EngineScene::kResting;
  auto models = rests ? loadModels(resting) : graspModels(scene, plan);
  if (!models) return models.errors();
  Intention intention = intentionOf(scene, plan, *models);
  RigOptions options;
  options.engine = engine;
  options.period_s = 1.0 / plan.rate_hz;
  auto rig = buildRig(std::move(*models), std::move(intention), options);
  if (!rig) return rig.errors();
  if (auto armed = (*rig)->renderer->arm(); !armed) return armed.errors();
  return rig;
}

}  // namespace wholehand
