#pragma once

#include "assembly/models.hpp"
#include "control/coupling_gains.hpp"
#include "device/haptic_device.hpp"
#include "patient/motion.hpp"
#include "physics/physics_world.hpp"
#include "renderer/haptic_renderer.hpp"

#include <memory>

namespace wholehand {

struct RigOptions {
  double period_s = 1e-3;
  std::string engine = "bullet";
  bool uncertified = false;  ///< allow gains that the stability check refuses
};

/// A renderer with everything it needs, built from models: the device (simulated unless one is
/// given), the world, the gains. Owns all of it; addresses stay fixed.
struct Rig {
  Models models;
  RigOptions options;
  CouplingGains gains;
  Diagnostics refused;  ///< what the stability check said; not empty only with `uncertified`
  std::unique_ptr<HapticDevice> device;
  std::unique_ptr<PhysicsWorld> world;
  std::unique_ptr<HapticRenderer> renderer;
};

/// Builds a rig around a simulated device whose patient follows `intention`.
[[nodiscard]] Expected<std::unique_ptr<Rig>> buildRig(Models models, Intention intention,
                                                      const RigOptions& options);

/// The same around any device.
[[nodiscard]] Expected<std::unique_ptr<Rig>> buildRig(Models models,
                                                      std::unique_ptr<HapticDevice> device,
                                                      const RigOptions& options);

/// The coupling gains and what the stability check thinks of them, over sampled postures.
struct CheckedGains {
  CouplingGains gains;
  Diagnostics refused;  ///< empty: certified
};
[[nodiscard]] Expected<CheckedGains> checkGains(const Models& models, double period_s);

}  // namespace wholehand
