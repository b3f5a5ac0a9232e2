#include "rig/rig.hpp"

#include "certify/certificate_refusal.hpp"
#include "loop/device/simulated/simulated_device.hpp"
#include "loop/dynamics/articulated_body.hpp"
#include "loop/patient/motion.hpp"
#include "loop/patient/player.hpp"
#include "loop/renderer/live_settings.hpp"
#include "loop/safety/neutral_ramp.hpp"
#include "rig/arming.hpp"
#include "rig/models.hpp"
#include "rig/prescribed_guides.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <initializer_list>
#include <string>
#include <utility>

namespace wholehand {
namespace {

void refuseAbove(int most, std::size_t count, const char* key, const char* what,
                 Diagnostics& refused) {
  if (std::cmp_less_equal(count, most)) return;
  refused.push_back(keyFault("", key, std::to_string(count), "is more than a tick has room for",
                             std::string("at most ") + std::to_string(most) + " " + what));
}

// Slew rate of the ramp to neutral at its steepest, from one effort limit to the other. A lower
// slew limit would reach neutral too late.
double leastSlew(const DeviceAxis& axis) {
  return 2.0 * axis.effort_limit * 1.5 / NeutralRampConfig{}.ramp_s;
}

// True for a usable limit. A limit of 0 renders nothing and NaN limits nothing.
bool isLimit(double value) {
  return std::isfinite(value) && value > 0.0;
}

// These checks repeat those of the loaders, because a program may change its models after loading.

/// Refuses models larger than a tick has room for.
Diagnostics refuseTooLarge(const Models& m) {
  Diagnostics refused;
  refuseAbove(kMaxSceneBodies, m.scene.bodies.size(), "bodies", "bodies in a scene", refused);
  refuseAbove(kMaxLinks, m.hand.links.size(), "links", "links in a hand", refused);
  refuseAbove(kMaxJoints, std::max(m.hand.joint_count, 0), "joints", "joints in a hand", refused);
  const std::size_t axes = std::max(m.hand.axis_count, 0);
  refuseAbove(kMaxAxes, std::max(axes, m.device.axes.size()), "axes", "axes of a device", refused);
  for (const Prescription::Limit& limit :
       m.prescription ? m.prescription->limits : std::vector<Prescription::Limit>{}) {
    if (limit.axis >= 0 && limit.axis < m.device.axisCount()) continue;
    refused.push_back(keyFault(m.prescription->path, "limits", std::to_string(limit.axis),
                               "is the index of no axis of the device", "read the file anew"));
  }
  if (m.exercise == nullptr) return refused;
  const ExerciseDescription& exercise = m.exercise->description();
  refuseAbove(kMaxLiveParameters - kMostLiveSettings, exercise.parameters.size(), "parameters",
              "live parameters of an exercise", refused);
  refuseAbove(kMaxExerciseValues, exercise.value_names.size(), "values", "values of an exercise",
              refused);
  return refused;
}

/// Refuses a device whose limits are ineffective or cannot be kept: not a number, zero, a reversed
/// range, a neutral effort beyond the limit, or a slew limit too low to reach neutral in time.
Diagnostics refuseImpossibleLimits(const DeviceModel& device) {
  Diagnostics refused;
  const auto refuse = [&](const std::string& axis, const char* key, double value, const char* why,
                          const std::string& remedy) {
    refused.push_back({device.path, 0, axis + key, fmt::format("{:.6g}", value), why, remedy});
  };
  for (const DeviceAxis& axis : device.axes) {
    const std::string of = axis.name + ".";
    if (!isLimit(axis.effort_limit)) {
      refuse(of, "effort_limit", axis.effort_limit, "is not a valid limit", "must be a number > 0");
    }
    if (!isLimit(axis.speed_limit)) {
      refuse(of, "speed_limit", axis.speed_limit, "is not a valid limit", "must be a number > 0");
    }
    const double least_slew = leastSlew(axis);
    if (!isLimit(axis.effort_slew_limit) || axis.effort_slew_limit < least_slew) {
      refuse(of, "effort_slew_limit", axis.effort_slew_limit,
             "is not a number, or too low to reach neutral within 100 ms",
             fmt::format("must be at least {:.6g}", least_slew));
    }
    if (!(std::isfinite(axis.lower) && std::isfinite(axis.upper) && axis.lower < axis.upper)) {
      refuse(of, "range", axis.lower, "is not a valid range",
             "the lower end must be below the upper one");
    }
    if (!(std::isfinite(axis.workspace_margin) && axis.workspace_margin >= 0.0)) {
      refuse(of, "workspace_margin", axis.workspace_margin, "is not a valid margin",
             "must be >= 0");
    }
    if (!(std::abs(axis.neutral_effort) <= axis.effort_limit)) {
      refuse(of, "neutral_effort", axis.neutral_effort, "exceeds the effort limit",
             "the device could not carry its own weight");
    }
  }
  if (!(device.power_limit_w > 0.0)) {  // infinity means no limit
    refuse("", "power_limit_w", device.power_limit_w, "is not a valid limit", "must be > 0");
  }
  return refused;
}

/// Refuses a stated armature that makes the mass rendered in free motion larger than the device's
/// own moving mass.
Diagnostics refuseHeavyArmature(const Models& models, const CouplingGains& gains, double period_s) {
  Diagnostics refused;
  for (int a = 0; a < gains.axes; ++a) {
    const DeviceAxis& axis = models.device.axes[a];
    const AxisRendering& rendering = models.rendering.axes[a];
    const double felt = feltInertia(gains, a, period_s);
    if (!rendering.armature || felt <= axis.mass) continue;
    const bool translation = axis.kind == AxisKind::kTranslation;
    const char* unit = translation ? "kg" : "kg·m²";
    const double lever_sq = axis.lever_arm_m * axis.lever_arm_m;
    const std::string at_tip =
        lever_sq > 0.0 ? fmt::format(", {:.3g} g at the tip", 1e3 * felt / lever_sq) : "";
    refused.push_back(keyFault(
        models.rendering.path,
        fmt::format("axes[{}].armature_{}", axis.name, translation ? "kg" : "kg_m2"),
        fmt::format("{:.6g}", *rendering.armature),
        fmt::format("makes the hand a weight: the avatar is felt as {:.3g} {}{}, the device itself "
                    "as {:.3g}",
                    felt, unit, at_tip, axis.mass),
        "state less, or leave it out: the rule then adds what the rate needs"));
  }
  return refused;
}

void add(std::string& text, std::initializer_list<double> values) {
  for (const double value : values) text += fmt::format("{:.17g};", value);
}

void add(std::string& text, const Eigen::Ref<const Eigen::MatrixXd>& m) {
  for (Eigen::Index j = 0; j < m.cols(); ++j) {
    for (Eigen::Index i = 0; i < m.rows(); ++i) add(text, {m(i, j)});
  }
}

void add(std::string& text, const Pose& pose) {
  add(text, pose.rotation);
  add(text, pose.translation_m);
}

// Adds device properties that the certificate's fingerprint does not contain.
void addDevice(std::string& text, const DeviceModel& device) {
  add(text, {device.mount_roll_rad, device.mount_pitch_rad, device.mount_yaw_rad});
  for (const DeviceAxis& axis : device.axes) {
    text += axis.name + ";";
    add(text, {axis.lower, axis.upper, axis.effort_limit, axis.neutral_effort});
  }
}

void addHand(std::string& text, const HandModel& hand) {
  for (const HandLink& link : hand.links) {
    add(text, link.parent_to_link);
    add(text, link.axis);
    add(text, {static_cast<double>(link.parent), static_cast<double>(link.joint), link.mass_kg});
  }
  for (const Capsule& capsule : hand.capsules) {
    add(text, capsule.a_m);
    add(text, capsule.b_m);
    add(text, {static_cast<double>(capsule.link), capsule.radius_m});
  }
  add(text, hand.synergy);
}

void addShape(std::string& text, const Shape& shape) {
  add(text, {static_cast<double>(shape.type), shape.radius_m, shape.length_m});
  add(text, shape.half_extents_m);
  add(text, shape.in_body);
  for (const Eigen::Vector3d& point : shape.points_m) add(text, point);
}

void addScene(std::string& text, const SceneModel& scene) {
  add(text, scene.gravity_m_s2);
  add(text, {scene.hand_friction});
  for (const SceneBody& body : scene.bodies) {
    add(text, {body.fixed ? 1.0 : 0.0, body.mass_kg, body.friction, body.linear_damping_per_s,
               body.soft_m});
    add(text, body.com_m);
    add(text, body.inertia_kg_m2);
    add(text, body.pose);
    for (const Shape& shape : body.shapes) addShape(text, shape);
    text += "|";
  }
  const GameBudget& game = scene.game;
  if (game.slots == 0) return;
  for (const int count : {game.slots, game.awake, game.shape_sets, game.pieces, game.vertices}) {
    add(text, {static_cast<double>(count)});
  }
  add(text, {game.least_kg, game.most_kg, game.least_m, game.most_m});
}

// The device with the worst values of its file and of every measured corner. All parts of the rig
// use it.
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
  if (models.prescription) config.guides = guidesOf(models, period_s);
  config.live = LiveSettings(device, config.damping);
  return config;
}

// States whether the device may move a person, which decides what arm() requires.
enum class Moves { kMaybeAPerson, kNobody };

Expected<std::unique_ptr<Rig>> buildAround(Models models, std::unique_ptr<HapticDevice> device,
                                           const RigOptions& given, Moves moves,
                                           const KnownPerson* person) {
  if (Diagnostics large = refuseTooLarge(models); !large.empty()) return large;
  if (Diagnostics limits = refuseImpossibleLimits(models.device); !limits.empty()) return limits;
  Expected<CheckedGains> checked = checkGainsAtArming(models, *device, given);
  if (!checked) return checked.errors();
  const RigOptions options = withDelayOf(*device, given);
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
  rig->renderer = std::make_unique<HapticRenderer>(*rig->device, *rig->world, rig->models.hand,
                                                   rig->models.scene, config,
                                                   rig->models.exercise.get(), person);
  return rig;
}

Diagnostics refuseUnlessPassed(const CertificateInput& input) {
  return passesCertificate(input) ? Diagnostics{} : refuseUncertified(input);
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
    at_corner.persons = Persons::kAny;  // a measured device moves a person
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
  return {fileFault(options.certificate->path, difference,
                    "certify these files, or leave out --certificate")};
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
  const KnownPerson& person = *device;
  auto rig = buildRigWithoutPerson(std::move(models), std::move(device), options, &person);
  if (rig) (*rig)->listener = std::move(listener);
  return rig;
}

Expected<std::unique_ptr<Rig>> buildRig(Models models, std::unique_ptr<HapticDevice> device,
                                        const RigOptions& options) {
  if (options.uncertified) {
    return keyFault("", "uncertified", "true", "is for simulated and replayed devices only",
                    "use gains that `wholehand certify` accepts");
  }
  return buildAround(std::move(models), std::move(device), options, Moves::kMaybeAPerson, nullptr);
}

Expected<std::unique_ptr<Rig>> buildRigWithoutPerson(Models models,
                                                     std::unique_ptr<HapticDevice> device,
                                                     const RigOptions& options,
                                                     const KnownPerson* person) {
  return buildAround(std::move(models), std::move(device), options, Moves::kNobody, person);
}

std::string rehearsalFingerprint(const Models& models, const RigOptions& options,
                                 const CertificateFingerprint& certified) {
  std::string text = options.engine + ";";
  add(text, {options.period_s});
  for (const FingerprintPart& part : certified.parts) text += part.name + ":" + part.hash + ";";
  // Stiffnesses are part of the certificate. Narrower limits need no new rehearsal.
  if (models.prescription) {
    const PersonGuidesConfig guides = guidesOf(models, options.period_s);
    for (const double most : guides.walls.most) add(text, {most});
    if (guides.corridor) add(text, {guides.corridor->most_n});
  }
  addDevice(text, models.device);
  addHand(text, models.hand);
  addScene(text, models.scene);
  return hashOf(text);
}

}  // namespace wholehand
