#pragma once

#include "assembly/engines.hpp"
#include "assembly/models.hpp"
#include "control/certificate_fingerprint.hpp"
#include "control/coupling_gains.hpp"
#include "core/tick_listener.hpp"
#include "device/haptic_device.hpp"
#include "patient/motion.hpp"
#include "patient/player.hpp"
#include "physics/physics_world.hpp"
#include "renderer/haptic_renderer.hpp"

#include <memory>
#include <optional>
#include <string>
#include <vector>

namespace wholehand {

struct RigOptions {
  double period_s = 1e-3;
  std::string engine = defaultEngine();
  bool uncertified = false;  ///< allow gains that are not certified; where nobody is moved
  /// What the run was certified as: it then renders nothing else. Without one it certifies itself.
  struct NamedCertificate {
    std::string path;
    CertificateFingerprint fingerprint;
  };
  std::optional<NamedCertificate> certificate = std::nullopt;
  /// The device at the worst corners of what was measured of it (commissioning/passport.hpp): the
  /// gains must be certified with each of them, too, and the energy tank counts on the least
  /// damping of all. Empty: nothing was measured.
  std::vector<DeviceModel> measured = {};
  /// Digest of the passport that a real device was armed with, or why it had none; empty on a
  /// simulated or replayed device. Kept in recordings.
  std::string passport = {};
  /// What that passport says, so that a recording can carry it; empty where there is none.
  std::string passport_text = {};
};

/// A renderer with everything it needs, built from models: the device (simulated unless one is
/// given), the world, the gains. Owns all of it; addresses stay fixed. Closes the device at its
/// end.
struct Rig {
  Rig() = default;
  ~Rig();
  Rig(const Rig&) = delete;
  Rig& operator=(const Rig&) = delete;

  Models models;
  RigOptions options;
  CouplingGains gains;
  Diagnostics refused;  ///< why they are not certified; not empty only with `uncertified`
  std::unique_ptr<HapticDevice> device;
  std::unique_ptr<TickListener> listener;  ///< tells a simulated device's player; null on others
  std::unique_ptr<PhysicsWorld> world;
  std::unique_ptr<HapticRenderer> renderer;
};

// All three refuse models that are larger than what a tick has room for.

/// Builds a rig around a simulated device whose patient follows `intention`.
[[nodiscard]] Expected<std::unique_ptr<Rig>> buildRig(Models models, Intention intention,
                                                      const RigOptions& options);

/// The same where the patient does what a player wants.
[[nodiscard]] Expected<std::unique_ptr<Rig>> buildRig(Models models, std::unique_ptr<Player> player,
                                                      const RigOptions& options);

/// The same around any device. It may hold a person: `uncertified` is refused, and where it is not
/// simulated() arm() asks for a passed rehearsal (assembly/rehearsal.hpp).
[[nodiscard]] Expected<std::unique_ptr<Rig>> buildRig(Models models,
                                                      std::unique_ptr<HapticDevice> device,
                                                      const RigOptions& options);

/// The same around a device that moves nobody, `uncertified` or not: a replayed or scripted one.
/// arm() asks for no rehearsal.
/// @pre whatever is written to the device, no person feels it
[[nodiscard]] Expected<std::unique_ptr<Rig>> buildRigThatMovesNobody(
    Models models, std::unique_ptr<HapticDevice> device, const RigOptions& options);

/// The coupling gains and why they are not certified (docs/certificate.md), with this hand and the
/// walls of this exercise.
struct CheckedGains {
  CouplingGains gains;
  Diagnostics refused;  ///< empty: certified
  CertificateFingerprint fingerprint;
};
/// @param measured the device at the corners of its passport; why one is refused says so
[[nodiscard]] Expected<CheckedGains> checkGains(const Models& models, double period_s,
                                                const std::vector<DeviceModel>& measured = {});

/// Why gains may not be rendered under these options: they are not certified, or the options name a
/// certificate of others. Empty: they may.
[[nodiscard]] Diagnostics refuseToRender(const CheckedGains& checked, const RigOptions& options);

}  // namespace wholehand
