#include "experiments/sweep/contact_trial.hpp"

#include "certify/certificate.hpp"
#include "experiments/felt_noise.hpp"
#include "experiments/grasp_script.hpp"
#include "rig/models.hpp"

#include <algorithm>
#include <cmath>
#include <memory>
#include <utility>

namespace wholehand {
namespace {

constexpr double kRests_s = 3.0;  // from this time on the hand, which closed at 2.8 s, is at rest

void fixInPlace(SceneBody& object) {
  object.fixed = true;
  object.mass_kg = 0.0;
  object.inertia_kg_m2.setZero();
}

double deepest(const TickRecord& r) {
  double depth_m = 0.0;
  for (int i = 0; i < r.contact_count; ++i) {
    depth_m = std::max(depth_m, -r.contacts.at(static_cast<std::size_t>(i)).distance_m);
  }
  return depth_m;
}

}  // namespace

Expected<ContactResult> runContact(const GraspTrial& trial, const ModelFiles& files,
                                   const TrialSetup& setup) {
  auto models = loadTrial(trial, files, setup);
  if (!models) return models.errors();
  fixInPlace(models->scene.bodies.front());
  const Certificate certificate = certify(certificateInput(*models, setup.rig.period_s));
  Intention intention = graspIntention(trial, *models);
  auto rig = buildRig(std::move(*models), std::move(intention), setup.rig);
  if (!rig) return rig.errors();
  HapticRenderer& renderer = *(*rig)->renderer;
  if (auto armed = renderer.arm(); !armed) return armed.errors();

  ContactResult result;
  result.certified = certificate.certified;
  result.margin = certificate.margin();
  FeltNoise noise((*rig)->models.device);
  const auto record = std::make_unique<TickRecord>();
  const auto ticks =
      static_cast<std::uint64_t>(std::llround(grasp_times::kLiftBegins / setup.rig.period_s));
  for (std::uint64_t k = 0; k < ticks; ++k) {
    record->tick = k;
    record->time_s = static_cast<double>(k) * setup.rig.period_s;
    renderer.tick(1, *record);
    result.penetration_m = std::max(result.penetration_m, deepest(*record));
    if (record->time_s >= kRests_s) noise.add(*record);
  }
  result.faulted = any(renderer.latched());
  result.noise_n = noise.worst();
  result.stable = !result.faulted && result.noise_n <= ContactResult::kRests_n;
  return result;
}

}  // namespace wholehand
