#pragma once

#include "certify/certificate.hpp"
#include "loop/control/bilateral_coupling.hpp"
#include "loop/core/tick_record.hpp"
#include "loop/device/haptic_device.hpp"
#include "loop/patient/motion.hpp"
#include "loop/patient/player.hpp"
#include "loop/physics/physics_world.hpp"
#include "loop/renderer/haptic_renderer.hpp"
#include "rig/engines.hpp"
#include "rig/models.hpp"

#include <memory>
#include <optional>
#include <string>
#include <vector>

namespace wholehand {

struct RigOptions {
  double period_s = 1e-3;
  std::string engine = defaultEngine();
  bool uncertified = false;  ///< allows uncertified gains; only for devices that move nobody
  /// Certificate that the run must match, or nothing is rendered. Without one the gains are
  /// certified when the rig is built.
  struct NamedCertificate {
    std::string path;
    CertificateFingerprint fingerprint;
  };
  std::optional<NamedCertificate> certificate = std::nullopt;
  /// The device at the worst corners of its passport (devices/passport/passport.hpp). The
  /// gains must also be certified at each corner, and the energy tank uses the least damping of all
  /// corners. Empty: not measured.
  std::vector<DeviceModel> measured = {};
  /// Digest of the passport that a real device was armed with, or the reason why it had none; empty
  /// for a simulated or replayed device. Stored in recordings.
  std::string passport = {};
  /// Text of that passport, stored in recordings; empty without one.
  std::string passport_text = {};
};

/// A renderer with all its parts, built from models: the device (simulated unless one is given),
/// the world, the gains. Owns all parts at fixed addresses. The destructor closes the device.
struct Rig {
  Rig() = default;
  ~Rig();
  Rig(const Rig&) = delete;
  Rig& operator=(const Rig&) = delete;

  Models models;
  RigOptions options;
  CouplingGains gains;
  Diagnostics refused;  ///< why the gains are not certified; non-empty only with `uncertified`
  std::unique_ptr<HapticDevice> device;
  std::unique_ptr<TickListener>
      listener;  ///< forwards records to the player of a simulated device; null otherwise
  std::unique_ptr<PhysicsWorld> world;
  std::unique_ptr<HapticRenderer> renderer;
};

// The following functions refuse models that exceed the capacity of a tick.

/// Builds a rig around a simulated device whose patient follows `intention`.
[[nodiscard]] Expected<std::unique_ptr<Rig>> buildRig(Models models, Intention intention,
                                                      const RigOptions& options);

/// Builds a rig around a simulated device whose patient follows a player.
[[nodiscard]] Expected<std::unique_ptr<Rig>> buildRig(Models models, std::unique_ptr<Player> player,
                                                      const RigOptions& options);

/// Builds a rig around any device, which may hold a person. Refuses `uncertified`. Unless the
/// device is simulated(), arm() requires a passed rehearsal (rig/rehearsal.hpp).
[[nodiscard]] Expected<std::unique_ptr<Rig>> buildRig(Models models,
                                                      std::unique_ptr<HapticDevice> device,
                                                      const RigOptions& options);

/// Builds a rig around a device that moves nobody, such as a replayed or scripted one.
/// `uncertified` is allowed, and arm() requires no rehearsal.
/// @param person source of the person's data in the records; often the device itself. Null: none
/// @pre no person is connected to the device
[[nodiscard]] Expected<std::unique_ptr<Rig>> buildRigWithoutPerson(
    Models models, std::unique_ptr<HapticDevice> device, const RigOptions& options,
    const KnownPerson* person = nullptr);

/// The coupling gains, and the reasons why they are not certified (docs/certificate.md) with this
/// hand and the walls of this exercise.
struct CheckedGains {
  CouplingGains gains;
  Diagnostics refused;  ///< empty: certified
  CertificateFingerprint fingerprint;
};
/// @param measured the device at the corners of its passport; a refusal names the corner
[[nodiscard]] Expected<CheckedGains> checkGains(const Models& models, double period_s,
                                                const std::vector<DeviceModel>& measured = {});

/// Reasons why the gains may not be rendered with these options: they are not certified, or the
/// certificate of the options is for other gains. Empty: allowed.
[[nodiscard]] Diagnostics refuseToRender(const CheckedGains& checked, const RigOptions& options);

/// Fingerprint of everything that determines the worst contacts and their cost: device, hand,
/// gains, scene, exercise, engine and rate; not the patient. Rigs with equal fingerprints have
/// equal rehearsals.
[[nodiscard]] std::string rehearsalFingerprint(const Models& models, const RigOptions& options,
                                               const CertificateFingerprint& certified);

}  // namespace wholehand
