#include "assembly/run_files.hpp"

#include "assembly/program_version.hpp"
#include "assembly/sampled_inertia.hpp"
#include "core/printable.hpp"
#include "files/durable_file.hpp"
#include "files/text_file.hpp"

#include <fmt/chrono.h>
#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdint>
#include <filesystem>
#include <utility>

namespace wholehand {
namespace fs = std::filesystem;
namespace {

/// Whether the files, in their present state, match what the rig renders.
bool sayWhatIsRendered(const ModelFiles& files, const Rig& rig) {
  const auto again = loadModels(files);
  if (!again) return false;
  const auto certified = fingerprintOf(certificateInput(*again, rig.options.period_s));
  return rehearsalFingerprint(*again, rig.options, certified) == rig.renderer->config().rehearsal;
}

}  // namespace

void describeAxes(const DeviceModel& device, RecordingMeta& meta) {
  for (const DeviceAxis& axis : device.axes) {
    meta.axis_names.push_back(axis.name);
    meta.axis_units.push_back(axis.positionUnit());
    meta.effort_limits.push_back(axis.effort_limit);
    meta.lever_arms_m.push_back(axis.lever_arm_m);
    meta.encoder_step.push_back(axis.encoder_step);
  }
}

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
  describeAxes(rig.models.device, meta);
  for (double q : rig.renderer->armedPosition()) meta.armed_position.push_back(q);
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

std::string blackBoxPath(const std::string& recording) {
  if (fs::path(recording).extension() == ".wbb") return recording + ".wbb";
  if (!recording.empty()) return fs::path(recording).replace_extension(".wbb").string();
  std::string stem = fmt::format("out/blackbox/{:%Y%m%d-%H%M%S}",
                                 fmt::localtime(std::chrono::system_clock::now()));
  std::error_code nowhere;
  if (!checkFiles({stem + ".wbb"})) stem = fs::temp_directory_path(nowhere) / stem;
  // Few boxes are ever written, so no file takes the name now; chance keeps two programs apart.
  return stem + "-" + randomName().substr(0, 8) + ".wbb";
}

Expected<std::unique_ptr<BlackBox>> armBlackBox(const Rig& rig, const RecordingMeta& meta,
                                                const std::string& path, std::uint64_t most_ticks) {
  BlackBoxPlan plan;
  plan.path = path;
  plan.most_ticks = most_ticks;
  plan.stop = [](void* renderer) noexcept {
    static_cast<HapticRenderer*>(renderer)->requestEmergencyStop();
  };
  plan.stop_whom = rig.renderer.get();
  return BlackBox::arm(meta, plan);
}

std::string writeBlackBoxIfNeeded(BlackBox& box) {
  if (!box.wanted()) return {};
  if (auto written = box.write(); !written) return format(written.errors());
  return fmt::format("the last seconds and what led to them: wholehand replay {} --resimulate",
                     box.path());
}

}  // namespace wholehand
