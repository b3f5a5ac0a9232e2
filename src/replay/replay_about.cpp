#include "replay/replay_about.hpp"

#include "replay/embedded_name.hpp"

#include <nlohmann/json.hpp>

#include <algorithm>
#include <cstddef>

namespace wholehand {
namespace {

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

// Results in the last tick.
Json resultsOf(RecordingReader& recording) {
  const RecordingMeta& meta = recording.meta();
  Json results = Json::array();
  TickRecord last;
  if (meta.result_names.empty() || !recording.read(recording.size() - 1, last)) return results;
  for (std::size_t i = 0; i < meta.result_names.size(); ++i) {
    const auto at =
        std::find(meta.value_names.begin(), meta.value_names.end(), meta.result_names[i]) -
        meta.value_names.begin();
    if (at >= last.exercise.value_count) continue;
    const double shown = last.exercise.values[at] * meta.result_factors[i];
    results.push_back({{"name", meta.result_names[i]},
                       {"label", meta.result_labels[i]},
                       {"unit", meta.result_units[i]},
                       {"value", shown},
                       {"decimals", std::clamp(meta.result_decimals[i], 0.0, 6.0)}});
  }
  return results;
}

// The checks that resimulate() makes first.
bool canRunAgain(const RecordingReader& recording) {
  const RecordingMeta& meta = recording.meta();
  const RecordingOutline& outline = recording.outline();
  return !meta.models_changed && outline.numbers.front() == 0 && outline.missing == 0;
}

}  // namespace

std::string replayAbout(const ViewedRecording& viewed, const std::string& name, bool still_written,
                        const SceneFacts& facts, const std::string& no_picture_because) {
  RecordingReader& recording = *viewed.reader;
  const RecordingMeta& meta = recording.meta();
  const RecordingOutline& outline = recording.outline();
  const auto known = [&](const std::string& text, const char* kind) {
    return text.empty() ? embeddedName(meta, kind) : text;
  };
  const auto time_s = [&](std::uint64_t tick) { return static_cast<double>(tick) * meta.period_s; };
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
                {"result", resultsOf(recording)}};
  if (viewed.unreadable_from_tick) {
    about["unreadable_from_s"] = time_s(*viewed.unreadable_from_tick);
  }
  if (!no_picture_because.empty()) about["no_picture_because"] = no_picture_because;
  return about.dump(-1, ' ', false, Json::error_handler_t::replace) + "\n";
}

}  // namespace wholehand
