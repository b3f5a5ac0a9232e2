#include "lab/engine_scenes.hpp"

#include "experiments/grasp_script.hpp"
#include "files/text_file.hpp"

#include <cmath>
#include <utility>

namespace wholehand {
namespace {

/// The hand above the table, clear of everything.
Intention clearOfTheTable(const DeviceModel& device) {
  AxisPosition q(device.axisCount());
  if (const int x = device.axisIndex("x"); x >= 0) q[x] = -0.08;
  if (const int z = device.axisIndex("z"); z >= 0) q[z] = 0.11;
  return Intention::throughWaypoints({{0.0, q}});
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

}  // namespace

const char* engineSceneName(EngineScene scene) {
  constexpr std::array<const char*, kEngineScenes> kNames{"free", "fixed", "held", "resting"};
  return kNames.at(static_cast<std::size_t>(scene));
}

GraspTrial comparedGrasp() {
  for (const GraspTrial& trial : tunedTrials()) {
    if (trial.shape == "cylinder" && !trial.gravity) return trial;
  }
  return {};
}

std::uint64_t ticksOf(EngineScene scene, double hold_s, double period_s) {
  double end_s = grasp_times::kLiftBegins;  // free and fixed: closed, and not yet lifting
  if (scene == EngineScene::kHeld) end_s = grasp_times::kHoldBegins + hold_s;
  if (scene == EngineScene::kResting) end_s = hold_s;
  return static_cast<std::uint64_t>(std::llround(end_s / period_s));
}

Expected<std::unique_ptr<Rig>> buildScene(EngineScene scene, const EnginePlan& plan,
                                          const std::string& engine) {
  ModelFiles resting = plan.files;
  resting.scene = plan.resting_file;
  const bool rests = scene == EngineScene::kResting;
  auto models = rests ? loadModels(resting) : graspModels(scene, plan);
  if (!models) return models.errors();
  Intention intention =
      rests ? clearOfTheTable(models->device) : graspIntention(comparedGrasp(), *models);
  RigOptions options;
  options.engine = engine;
  options.period_s = 1.0 / plan.rate_hz;
  auto rig = buildRig(std::move(*models), std::move(intention), options);
  if (!rig) return rig.errors();
  if (auto armed = (*rig)->renderer->arm(); !armed) return armed.errors();
  return rig;
}

}  // namespace wholehand
