#include "replay/recorded_scene.hpp"

#include "replay/resimulation/resimulation.hpp"
#include "station/scene_facts.hpp"

#include <nlohmann/json.hpp>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <sstream>
#include <utility>
#include <vector>

namespace wholehand {

namespace {

/// Value of a line `key = "value"` in a TOML text; empty when there is none.
std::string tomlText(const std::string& text, const std::string& key) {
  std::istringstream in(text);
  for (std::string line; std::getline(in, line);) {
    if (!line.starts_with(key)) continue;
    const std::size_t equals = line.find_first_not_of(" \t", key.size());
    if (equals == std::string::npos || line[equals] != '=') continue;
    const std::size_t open = line.find('"', equals);
    const std::size_t close = open == std::string::npos ? open : line.find('"', open + 1);
    if (close != std::string::npos) return line.substr(open + 1, close - open - 1);
  }
  return {};
}

template <class Item>
std::vector<std::string> namesOf(const std::vector<Item>& items) {
  std::vector<std::string> names;
  for (const Item& item : items) names.push_back(item.name);
  return names;
}

// Name of the first part in which the recording differs from the facts; empty: none. Poses of one
// hand must not be shown on the links of another.
std::string differenceFrom(const RecordingMeta& meta, const SceneFacts& facts) {
  if (meta.axis_names != namesOf(facts.device.axes)) return "axes";
  if (meta.joint_names != facts.hand.joint_names) return "joints";
  if (meta.capsule_names != namesOf(facts.hand.capsules)) return "capsules";
  if (meta.body_names != facts.scene.recordedBodies()) return "bodies";
  if (meta.value_names != facts.value_names) return "values of the exercise";
  return {};
}

using Json = nlohmann::json;

Json axesOf(const RecordingMeta& meta) {
  Json axes = Json::array();
  for (std::size_t a = 0; a < meta.axis_names.size(); ++a) {
    axes.push_back({{"name", meta.axis_names[a]},
                    {"unit", meta.axis_units[a]},
                    {"effort_limit", meta.effort_limits[a]},
                    {"lever_arm_m", meta.lever_arms_m[a]}});
  }
  return axes;
}

// The exercise's results at the last tick.
Json resultsOf(const RecordingMeta& meta, const TickRecord& last) {
  Json results = Json::array();
  for (std::size_t i = 0; i < meta.result_names.size(); ++i) {
    const auto at =
        std::find(meta.value_names.begin(), meta.value_names.end(), meta.result_names[i]) -
        meta.value_names.begin();
    if (at >= last.exercise.value_count) continue;
    const double shown = last.exercise.values[at] * meta.result_factors[i];
    if (!std::isfinite(shown)) continue;  // not measured
    results.push_back({{"name", meta.result_names[i]},
                       {"label", meta.result_labels[i]},
                       {"unit", meta.result_units[i]},
                       {"value", shown},
                       {"decimals", std::clamp(meta.result_decimals[i], 0.0, 6.0)}});
  }
  return results;
}

// True when resimulate() accepts the recording; makes the same checks.
bool canRunAgain(const RecordingReader& recording) {
  const RecordingMeta& meta = recording.meta();
  const RecordingOutline& outline = recording.outline();
  return !meta.models_changed && outline.numbers.front() == 0 && outline.missing == 0;
}

}  // namespace

std::string embeddedName(const RecordingMeta& meta, const std::string& kind) {
  for (const auto& [name, text] : meta.files) {
    if (tomlText(text, "kind") == kind) return tomlText(text, "name");
  }
  return {};
}

Expected<SceneFacts> recordedScene(const RecordingMeta& meta, const std::string& recording_path) {
  auto models = recordedModels(meta, recording_path);
  if (!models) return models.errors();
  SceneFacts facts = sceneFacts(*models, meta.period_s);
  facts.session = kReplayedSession;
  facts.program_version = meta.git_version;
  if (const std::string what = differenceFrom(meta, facts); !what.empty()) {
    return fileFault(recording_path, "its ticks have other " + what + " than the files in it",
                     "show it with the program that recorded it: " + meta.git_version);
  }
  return facts;
}

// Every session ends at the neutral effort or in a fault, and so does the recording of it.
const char* endedBy(const TickRecord& last) {
  if (last.safety_state == SafetyState::kFaulted) return "fault";
  return last.safety_state == SafetyState::kDisarmed ? "stop" : "broken_off";
}

LoopStatus recordedStatus(const TickRecord& record) {
  LoopStatus status;
  status.session = kReplayedSession;
  status.run_state = RunState::kRendering;
  status.safety_state = record.safety_state;
  status.latched = record.faults & kStoppingFaults;
  status.fault_axis = record.fault_axis;
  status.parameters.assign(record.parameters.begin(),
                           record.parameters.begin() + record.parameter_count);
  return status;
}

std::string replayAbout(const ViewedRecording& viewed, const std::string& name, bool still_written,
                        const SceneFacts& facts, const std::string& no_picture_because) {
  RecordingReader& recording = *viewed.reader;
  const RecordingMeta& meta = recording.meta();
  const RecordingOutline& outline = recording.outline();
  const auto known = [&](const std::string& text, const char* kind) {
    return text.empty() ? embeddedName(meta, kind) : text;
  };
  const auto time_s = [&](std::uint64_t tick) { return static_cast<double>(tick) * meta.period_s; };
  TickRecord last;
  const bool has_last = recording.read(recording.size() - 1, last);
  Json about = {{"name", name},
                {"title", meta.title},
                {"profile", meta.profile},
                {"created_utc", meta.created_utc},
                {"program_version", meta.git_version},
                {"period_s", meta.period_s},
                {"ticks", recording.size()},
                {"ticks_missing", outline.missing},
                {"from_s", time_s(outline.numbers.front())},
                {"to_s", time_s(viewed.last_tick) + meta.period_s},
                {"simulated_device", meta.simulated_device},
                {"patient", known(facts.patient_name, "patient")},
                {"device", known(facts.device.name, "device")},
                {"hand", known(facts.hand.name, "hand")},
                {"exercise", meta.exercise},
                {"level", meta.level},
                {"still_written", still_written},
                {"whole", !viewed.unreadable_from_tick},
                {"run_again", !viewed.unreadable_from_tick && canRunAgain(recording)},
                {"picture", no_picture_because.empty()},
                {"axes", axesOf(meta)},
                {"value_names", meta.value_names},
                {"event_names", meta.event_names},
                {"result", has_last ? resultsOf(meta, last) : Json::array()}};
  if (has_last && !still_written) about["ended_by"] = endedBy(last);
  if (viewed.unreadable_from_tick) {
    about["unreadable_from_s"] = time_s(*viewed.unreadable_from_tick);
  }
  if (!no_picture_because.empty()) about["no_picture_because"] = no_picture_because;
  return about.dump(-1, ' ', false, Json::error_handler_t::replace) + "\n";
}

}  // namespace wholehand
