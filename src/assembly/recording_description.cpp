#include "assembly/recording_description.hpp"

#include "assembly/inertia_polynomial.hpp"
#include "assembly/program_version.hpp"
#include "assembly/rehearsal_fingerprint.hpp"
#include "assembly/sampled_inertia.hpp"
#include "core/printable.hpp"
#include "files/text_file.hpp"

#include <fmt/chrono.h>
#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdint>
#include <utility>

namespace wholehand {
namespace {

/// Whether the files, in their present state, match what the rig renders.
bool sayWhatIsRendered(const ModelFiles& files, const Rig& rig) {
  const auto again = loadModels(files);
  if (!again) return false;
  const auto certified = fingerprintOf(certificateInput(*again, rig.options.period_s));
  return rehearsalFingerprint(*again, rig.options, certified) == rig.renderer->config().rehearsal;
}

RecordedLaw lawOf(const RendererConfig& config, const HandModel& hand, const DeviceModel& device) {
  const CouplingGains& gains = config.gains;
  const auto numbers = [](const auto& a) { return std::vector<double>(a.begin(), a.end()); };
  RecordedLaw law;
  law.k_pm = numbers(gains.k_pm);
  law.k_dm = numbers(gains.k_dm);
  law.gamma = numbers(gains.gamma);
  law.filter_tau_s = numbers(gains.filter_tau_s);
  law.theta0 = numbers(hand.theta0);
  for (const DeviceAxis& axis : device.axes) law.encoder_step.push_back(axis.encoder_step);
  law.output_delay_ticks = static_cast<std::uint64_t>(std::max(device.output_delay_ticks, 0));
  for (int j = 0; j < hand.joint_count; ++j) {
    for (int a = 0; a < hand.axis_count; ++a) law.synergy.push_back(hand.synergy(j, a));
  }
  const EnergyTankConfig& tank = config.safety.tank;
  const AdaptiveDampingConfig& damping = config.damping;
  if (tank.axes == gains.axes && damping.axes == gains.axes) {
    law.device_damping = numbers(tank.device_damping);
    law.tank_capacity = numbers(tank.capacity);
    law.effort_dead = numbers(damping.effort_dead);
    law.effort_full = numbers(damping.effort_full);
    law.hand_axis = numbers(damping.hand_axis);
    law.palm_contact = numbers(damping.palm_contact);
    for (const double decay_s : damping.decay_s) {
      law.phi_kept.push_back(decay_s > 0.0 ? std::exp(-config.period_s / decay_s) : 0.0);
    }
  }
  // A step of several ticks is not what the rule of q̇_s expects.
  if (gains.physics_divisor == 1) law.inertia = inertiaPolynomial(hand, device, gains.armature);
  return law;
}

}  // namespace

Expected<RecordingMeta> describeRecording(const Rig& rig, const std::string& title,
                                          std::uint64_t seed, bool simulated_clock) {
  auto files = readFileTexts(rig.models);
  if (!files) return files.errors();
  RecordingMeta meta;
  meta.created_utc =
      fmt::format("{:%Y-%m-%dT%H:%M:%SZ}", fmt::gmtime(std::chrono::system_clock::now()));
  meta.git_version = programVersion();
  meta.seed = seed;
  meta.period_s = rig.options.period_s;
  meta.engine = rig.options.engine;
  meta.simulated_clock = simulated_clock;
  meta.uncertified = !rig.refused.empty();
  meta.paper = rig.models.rendering.paper;
  meta.models_changed = !sayWhatIsRendered(rig.models.files, rig);
  meta.simulated_device = rig.device->simulated();
  meta.passport = rig.options.passport;
  meta.title = printable(title);
  for (const DeviceAxis& axis : rig.models.device.axes) {
    meta.axis_names.push_back(axis.name);
    meta.axis_units.push_back(axis.positionUnit());
    meta.effort_limits.push_back(axis.effort_limit);
    meta.lever_arms_m.push_back(axis.lever_arm_m);
  }
  for (double q : rig.renderer->armedPosition()) meta.armed_position.push_back(q);
  meta.law = lawOf(rig.renderer->config(), rig.models.hand, rig.models.device);
  meta.joint_names = rig.models.hand.joint_names;
  meta.body_names = rig.models.scene.recordedBodies();
  meta.game_slots = static_cast<std::uint64_t>(rig.models.scene.game.slots);
  for (const Capsule& capsule : rig.models.hand.capsules)
    meta.capsule_names.push_back(capsule.name);
  for (const LiveParameter& parameter : rig.renderer->liveParameters()) {
    meta.parameter_names.push_back(parameter.name);
  }
  meta.parameter_values = rig.renderer->parametersAtStart();
  if (const Exercise* exercise = rig.models.exercise.get()) {
    meta.exercise = exercise->description().name;
    meta.level = exercise->description().level;
    meta.value_names = exercise->description().value_names;
    meta.value_steps = exercise->description().value_steps;
    meta.event_names = exercise->description().event_names;
    for (const PanelValue& value : rig.models.exercise_panel.values) {
      if (!value.result) continue;
      meta.result_names.push_back(value.name);
      meta.result_labels.push_back(value.label.en);
      meta.result_units.push_back(value.unit);
      meta.result_factors.push_back(value.factor);
      meta.result_decimals.push_back(value.decimals);
    }
  }
  meta.files = std::move(*files);
  if (!rig.options.passport_text.empty()) {
    meta.files.emplace_back(kRecordedPassport, rig.options.passport_text);
  }
  return meta;
}

}  // namespace wholehand
