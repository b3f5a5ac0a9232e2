#include "assembly/rig.hpp"

#include "assembly/sampled_inertia.hpp"
#include "control/certificate_refusal.hpp"
#include "device/simulated/simulated_device.hpp"
#include "patient/scripted_player.hpp"
#include "physics/bullet/bullet_world.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <string>

namespace wholehand {
namespace {

RendererConfig rendererConfig(const Models& models, const CouplingGains& gains, double period_s,
                              bool simulated) {
  RendererConfig config;
  config.period_s = period_s;
  config.gains = gains;
  config.damping = makeAdaptiveDamping(models.device, models.rendering);
  config.neutral = models.device.neutral();
  config.effort_limit = AxisEffort(models.device.axisCount());
  for (int a = 0; a < models.device.axisCount(); ++a) {
    config.effort_limit[a] = models.device.axes[a].effort_limit;
  }
  config.gravity_m_s2 = models.scene.gravity_m_s2;
  config.tank = makeEnergyTank(models.device, period_s);
  config.supervisor = makeSupervisor(models.device, period_s, simulated);
  config.live = LiveSettings(models.device, config.damping);
  return config;
}

std::unique_ptr<PhysicsWorld> makeWorld(const Models& models, const std::string& engine) {
  if (engine == "bullet") return std::make_unique<BulletWorld>(models.hand, models.scene);
  return nullptr;
}

void refuseAbove(int most, std::size_t count, const char* key, const char* what,
                 Diagnostics& refused) {
  if (count <= static_cast<std::size_t>(most)) return;
  refused.push_back({"", 0, key, std::to_string(count), "are more than a tick has room for",
                     std::string("at most ") + std::to_string(most) + " " + what});
}

// Here, not in the loaders alone: a program may change its models after they were loaded.
Diagnostics refuseTooLarge(const Models& m) {
  Diagnostics refused;
  refuseAbove(kMaxBodies, m.scene.bodies.size(), "bodies", "bodies in a scene", refused);
  refuseAbove(kMaxLinks, m.hand.links.size(), "links", "links in a hand", refused);
  refuseAbove(kMaxJoints, static_cast<std::size_t>(std::max(m.hand.joint_count, 0)), "joints",
              "joints in a hand", refused);
  const auto axes = static_cast<std::size_t>(std::max(m.hand.axis_count, 0));
  refuseAbove(kMaxAxes, std::max(axes, m.device.axes.size()), "axes", "axes of a device", refused);
  return refused;
}

}  // namespace

Rig::~Rig() {
  if (device) device->close();
}

Expected<CheckedGains> checkGains(const Models& models, double period_s) {
  const CertificateInput input = certificateInput(models, period_s);
  Expected<CouplingGains> gains =
      resolveGains(models.rendering, input.inertia_at_reference, period_s);
  if (!gains) return gains.errors();
  CheckedGains out;
  out.gains = *gains;
  out.refused = refuseUncertified(input);
  out.fingerprint = fingerprintOf(input);
  return out;
}

Diagnostics refuseToRender(const CheckedGains& checked, const RigOptions& options) {
  if (!options.uncertified && !checked.refused.empty()) return checked.refused;
  if (!options.certificate) return {};
  const std::string difference =
      differenceOf(options.certificate->fingerprint, checked.fingerprint);
  if (difference.empty()) return {};
  return {{options.certificate->path, 0, "", "", difference,
           "certify these files, or leave out --certificate"}};
}

Expected<std::unique_ptr<Rig>> buildRig(Models models, Intention intention,
                                        const RigOptions& options) {
  return buildRig(std::move(models), std::make_unique<ScriptedPlayer>(std::move(intention)),
                  options);
}

Expected<std::unique_ptr<Rig>> buildRig(Models models, std::unique_ptr<Player> player,
                                        const RigOptions& options) {
  if (Diagnostics large = refuseTooLarge(models); !large.empty()) return large;
  auto device = std::make_unique<SimulatedDevice>(models.device, models.patient, std::move(player),
                                                  options.period_s);
  return buildRigThatMovesNobody(std::move(models), std::move(device), options);
}

Expected<std::unique_ptr<Rig>> buildRig(Models models, std::unique_ptr<HapticDevice> device,
                                        const RigOptions& options) {
  if (options.uncertified) {
    return Diagnostic{"",
                      0,
                      "uncertified",
                      "true",
                      "is for simulated and replayed devices only",
                      "use gains that `wholehand certify` accepts"};
  }
  return buildRigThatMovesNobody(std::move(models), std::move(device), options);
}

Expected<std::unique_ptr<Rig>> buildRigThatMovesNobody(Models models,
                                                       std::unique_ptr<HapticDevice> device,
                                                       const RigOptions& options) {
  if (Diagnostics large = refuseTooLarge(models); !large.empty()) return large;
  Expected<CheckedGains> checked = checkGains(models, options.period_s);
  if (!checked) return checked.errors();
  if (Diagnostics refused = refuseToRender(*checked, options); !refused.empty()) return refused;

  auto rig = std::make_unique<Rig>();
  rig->models = std::move(models);
  rig->options = options;
  rig->gains = checked->gains;
  rig->refused = checked->refused;
  rig->device = std::move(device);
  rig->world = makeWorld(rig->models, options.engine);
  if (!rig->world) {
    return Diagnostic{"", 0, "--engine", options.engine, "is not a known engine", "use bullet"};
  }
  rig->renderer = std::make_unique<HapticRenderer>(
      *rig->device, *rig->world, rig->models.hand,
      rendererConfig(rig->models, rig->gains, options.period_s, rig->device->simulated()),
      rig->models.exercise.get());
  return rig;
}

}  // namespace wholehand
