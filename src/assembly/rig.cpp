#include "assembly/rig.hpp"

#include "assembly/rehearsal_fingerprint.hpp"
#include "assembly/rig_checks.hpp"
#include "assembly/sampled_inertia.hpp"
#include "control/certificate/certificate_refusal.hpp"
#include "device/simulated/simulated_device.hpp"
#include "patient/player.hpp"
#include "patient/scripted_player.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <mutex>
#include <set>
#include <string>
#include <utility>

namespace wholehand {
namespace {

// The device at the worst of its file and every measured corner: what every part goes by.
DeviceModel provenDevice(DeviceModel device, const std::vector<DeviceModel>& measured) {
  for (const DeviceModel& corner : measured) {
    for (std::size_t i = 0; i < device.axes.size(); ++i) {
      DeviceAxis& axis = device.axes[i];
      const DeviceAxis& measured_axis = corner.axes[i];
      axis.damping = std::min(axis.damping, measured_axis.damping);
      axis.coulomb = std::min(axis.coulomb, measured_axis.coulomb);
      axis.mass = std::min(axis.mass, measured_axis.mass);
      axis.encoder_step = std::max(axis.encoder_step, measured_axis.encoder_step);
    }
    device.output_delay_ticks = std::max(device.output_delay_ticks, corner.output_delay_ticks);
  }
  return device;
}

RendererConfig rendererConfig(const Models& models, const CouplingGains& gains,
                              const RigOptions& options, bool simulated) {
  const double period_s = options.period_s;
  const DeviceModel device = provenDevice(models.device, options.measured);
  RendererConfig config;
  config.period_s = period_s;
  config.gains = gains;
  config.damping = makeAdaptiveDamping(device, models.rendering);
  config.safety.neutral = models.device.neutral();
  config.safety.effort_limit = AxisEffort(models.device.axisCount());
  for (int a = 0; a < models.device.axisCount(); ++a) {
    config.safety.effort_limit[a] = models.device.axes[a].effort_limit;
  }
  config.gravity_m_s2 = models.scene.gravity_m_s2;
  if (models.exercise) config.safety.ramp.fade_out_s = models.exercise->description().fade_out_s;
  config.safety.tank = makeEnergyTank(device, period_s);
  config.safety.supervisor = makeSupervisor(device, period_s, simulated);
  config.live = LiveSettings(device, config.damping);
  return config;
}

// Whether the device moves a person. It decides what arm() requires.
enum class Moves { kMaybeAPerson, kNobody };

Expected<std::unique_ptr<Rig>> buildAround(Models models, std::unique_ptr<HapticDevice> device,
                                           const RigOptions& options, Moves moves) {
  if (Diagnostics large = refuseTooLarge(models); !large.empty()) return large;
  if (Diagnostics limits = refuseImpossibleLimits(models.device); !limits.empty()) return limits;
  Expected<CheckedGains> checked = checkGains(models, options.period_s, options.measured);
  if (!checked) return checked.errors();
  if (Diagnostics refused = refuseToRender(*checked, options); !refused.empty()) return refused;
  if (moves == Moves::kMaybeAPerson && !device->simulated()) {
    if (Diagnostics refused = refuseForPersons(options.engine); !refused.empty()) return refused;
  }

  auto rig = std::make_unique<Rig>();
  rig->models = std::move(models);
  rig->options = options;
  rig->gains = checked->gains;
  rig->refused = checked->refused;
  rig->device = std::move(device);
  auto world = buildWorld(options.engine, rig->models.hand, rig->models.scene);
  if (!world) return world.errors();
  rig->world = std::move(*world);
  RendererConfig config =
      rendererConfig(rig->models, rig->gains, options, rig->device->simulated());
  config.rehearsal = rehearsalFingerprint(rig->models, options, checked->fingerprint);
  config.moves_nobody = moves == Moves::kNobody;
  rig->renderer =
      std::make_unique<HapticRenderer>(*rig->device, *rig->world, rig->models.hand,
                                       rig->models.scene, config, rig->models.exercise.get());
  return rig;
}

/// refuseUncertified() with a cache of inputs that passed in this process. Sessions, rehearsals and
/// levels ask for the same certificate, which takes most of the time of building a rig.
Diagnostics refuseUnlessPassed(const CertificateInput& input) {
  constexpr std::size_t kMost = 1000;
  static std::mutex mutex;
  static std::set<std::string> passed;
  std::string key = fmt::format("{:.17g} {}", input.period_s, static_cast<int>(input.persons));
  for (const FingerprintPart& part : fingerprintOf(input).parts) key += " " + part.hash;
  {
    const std::lock_guard lock(mutex);
    if (passed.contains(key)) return {};
  }
  Diagnostics refused = refuseUncertified(input);
  const std::lock_guard lock(mutex);
  if (refused.empty() && passed.size() < kMost) passed.insert(key);
  return refused;
}

}  // namespace

Rig::~Rig() {
  if (device) device->close();
}

Expected<CheckedGains> checkGains(const Models& models, double period_s,
                                  const std::vector<DeviceModel>& measured) {
  const CertificateInput input = certificateInput(models, period_s);
  Expected<CouplingGains> gains =
      resolveGains(models.rendering, input.inertia_at_reference, period_s);
  if (!gains) return gains.errors();
  CheckedGains out;
  out.gains = *gains;
  out.refused = refuseHeavyArmature(models, *gains, period_s);
  for (Diagnostic& refused : refuseUnlessPassed(input)) out.refused.push_back(std::move(refused));
  out.fingerprint = fingerprintOf(input);
  for (const DeviceModel& corner : measured) {
    CertificateInput at_corner = input;
    at_corner.device = corner;
    at_corner.persons = Persons::kAny;  // what was measured moves a person
    for (Diagnostic& refused : refuseUnlessPassed(at_corner)) {
      refused.problem = "at the worst corner of the passport: " + refused.problem;
      out.refused.push_back(std::move(refused));
    }
  }
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
  auto listener = std::make_unique<ListeningPlayer>(*player);
  auto device = std::make_unique<SimulatedDevice>(models.device, models.patient, std::move(player),
                                                  options.period_s);
  auto rig = buildRigWithoutPerson(std::move(models), std::move(device), options);
  if (rig) (*rig)->listener = std::move(listener);
  return rig;
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
  return buildAround(std::move(models), std::move(device), options, Moves::kMaybeAPerson);
}

Expected<std::unique_ptr<Rig>> buildRigWithoutPerson(Models models,
                                                     std::unique_ptr<HapticDevice> device,
                                                     const RigOptions& options) {
  return buildAround(std::move(models), std::move(device), options, Moves::kNobody);
}

}  // namespace wholehand
