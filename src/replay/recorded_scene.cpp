#include "replay/recorded_scene.hpp"

#include "resimulation/recorded_files.hpp"
#include "station/scene_facts.hpp"

#include <algorithm>
#include <utility>
#include <vector>

namespace wholehand {
namespace {

template <class Item>
std::vector<std::string> namesOf(const std::vector<Item>& items) {
  std::vector<std::string> names;
  for (const Item& item : items) names.push_back(item.name);
  return names;
}

// Poses of one hand must not be shown on the links of another.
std::string differenceFrom(const RecordingMeta& meta, const SceneFacts& facts) {
  if (meta.axis_names != namesOf(facts.device.axes)) return "axes";
  if (meta.joint_names != facts.hand.joint_names) return "joints";
  if (meta.capsule_names != namesOf(facts.hand.capsules)) return "capsules";
  if (meta.body_names != facts.scene.recordedBodies()) return "bodies";
  if (meta.value_names != facts.value_names) return "values of the exercise";
  return {};
}

}  // namespace

Expected<SceneFacts> recordedScene(const RecordingMeta& meta, const std::string& recording_path) {
  auto models = recordedModels(meta, recording_path);
  if (!models) return models.errors();
  SceneFacts facts = sceneFacts(*models, meta.period_s);
  facts.session = kReplayedSession;
  facts.program_version = meta.git_version;
  if (const std::string what = differenceFrom(meta, facts); !what.empty()) {
    return Diagnostic{recording_path,
                      0,
                      "",
                      "",
                      "its ticks have other " + what + " than the files in it",
                      "show it with the program that recorded it: " + meta.git_version};
  }
  return facts;
}

LoopStatus recordedStatus(const TickRecord& record) {
  LoopStatus status;
  status.session = kReplayedSession;
  status.run_state = RunState::kRendering;
  status.safety_state = record.safety_state;
  status.latched = record.faults & kStopping;
  status.fault_axis = record.fault_axis;
  status.parameters.assign(record.parameters.begin(),
                           record.parameters.begin() + record.parameter_count);
  return status;
}

}  // namespace wholehand
