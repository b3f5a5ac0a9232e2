#include "assembly/rig.hpp"

#include "control/stability.hpp"
#include "device/simulated/simulated_device.hpp"
#include "dynamics/articulated_body.hpp"
#include "dynamics/synergy.hpp"
#include "physics/bullet/bullet_world.hpp"

#include <array>
#include <cmath>

namespace wholehand {
namespace {

AxisMatrix reducedInertiaAt(const HandModel& hand, ArticulatedBody& body, const AxisPosition& q_s) {
  JointPosition theta;
  Synergy(hand).expand(q_s, theta);
  [[maybe_unused]] const bool definite =
      body.update(theta, JointVelocity(hand.joint_count), Eigen::Vector3d::Zero());
  return body.reducedInertia();
}

// Corners and middles of the ranges of the axes that change the hand's inertia. The inertia does
// not depend on where the base is, so translations stay at rest.
std::vector<AxisMatrix> sampleInertias(const HandModel& hand, const DeviceModel& device,
                                       ArticulatedBody& body) {
  std::vector<int> moving;
  for (int a = 0; a < device.axisCount(); ++a) {
    if (device.axes[a].kind == AxisKind::kRotation) moving.push_back(a);
  }
  int count = 1;
  for (std::size_t i = 0; i < moving.size(); ++i) count *= 3;
  std::vector<AxisMatrix> samples;
  for (int index = 0; index < count; ++index) {
    AxisPosition q_s(device.axisCount());
    int digits = index;
    for (int a : moving) {
      const DeviceAxis& axis = device.axes[a];
      q_s[a] = axis.lower + 0.5 * (digits % 3) * (axis.upper - axis.lower);
      digits /= 3;
    }
    samples.push_back(reducedInertiaAt(hand, body, q_s));
  }
  return samples;
}

RendererConfig rendererConfig(const Models& models, const CouplingGains& gains, double period_s) {
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
  return config;
}

std::unique_ptr<PhysicsWorld> makeWorld(const Models& models, const std::string& engine) {
  if (engine == "bullet") return std::make_unique<BulletWorld>(models.hand, models.scene);
  return nullptr;
}

}  // namespace

Expected<CheckedGains> checkGains(const Models& models, double period_s) {
  ArticulatedBody body(models.hand);
  const AxisMatrix at_reference = reducedInertiaAt(models.hand, body, models.hand.reference);
  Expected<CouplingGains> gains = resolveGains(models.rendering, at_reference, period_s);
  if (!gains) return gains.errors();
  CheckedGains out;
  out.gains = *gains;
  out.refused = checkStability(models.device, models.rendering, *gains,
                               sampleInertias(models.hand, models.device, body), period_s);
  return out;
}

Expected<std::unique_ptr<Rig>> buildRig(Models models, Intention intention,
                                        const RigOptions& options) {
  auto device = std::make_unique<SimulatedDevice>(models.device, models.patient,
                                                  std::move(intention), options.period_s);
  return buildRig(std::move(models), std::move(device), options);
}

Expected<std::unique_ptr<Rig>> buildRig(Models models, std::unique_ptr<HapticDevice> device,
                                        const RigOptions& options) {
  Expected<CheckedGains> checked = checkGains(models, options.period_s);
  if (!checked) return checked.errors();
  if (!checked->refused.empty() && !options.uncertified) return checked->refused;

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
  rig->renderer =
      std::make_unique<HapticRenderer>(*rig->device, *rig->world, rig->models.hand,
                                       rendererConfig(rig->models, rig->gains, options.period_s));
  return rig;
}

}  // namespace wholehand
