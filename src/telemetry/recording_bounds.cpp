#include "telemetry/recording_bounds.hpp"

#include "core/printable.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <utility>
#include <vector>

namespace wholehand::recording {
namespace {

// Far beyond any loop's rate: a file with such a period is damaged.
constexpr double kLeastPeriod_s = 1e-6, kMostPeriod_s = 1.0;
constexpr std::int32_t kMostContactsDropped = 1'000'000;

}  // namespace

std::string unusable(const RecordingMeta& meta) {
  const auto within = [](std::size_t n, int most) { return std::cmp_less_equal(n, most); };
  const std::size_t axes = meta.axis_names.size();
  if (axes == 0 || !within(axes, kMaxAxes)) {
    return "names " + std::to_string(axes) + " axes; 1 to " + std::to_string(kMaxAxes) +
           " are possible";
  }
  if (meta.axis_units.size() != axes || meta.effort_limits.size() != axes ||
      meta.lever_arms_m.size() != axes || meta.encoder_step.size() != axes ||
      meta.armed_position.size() != axes) {
    return "has not one unit, effort limit, lever arm, encoder step and armed position for each "
           "axis";
  }
  for (const std::vector<std::string>* texts :
       {&meta.axis_names, &meta.axis_units, &meta.joint_names, &meta.body_names,
        &meta.capsule_names, &meta.parameter_names, &meta.value_names, &meta.event_names,
        &meta.result_names, &meta.result_labels, &meta.result_units}) {
    if (!std::all_of(texts->begin(), texts->end(), [](const auto& t) { return isPrintable(t); })) {
      return "holds names that cannot be shown";
    }
  }
  for (const std::string& text :
       {meta.title, meta.profile, meta.created_utc, meta.git_version, meta.engine, meta.exercise}) {
    if (!isPrintable(text, 500)) return "holds texts that cannot be shown";
  }
  if (!within(meta.joint_names.size(), kMaxJoints)) return "names too many joints";
  if (!within(meta.body_names.size(), kMaxBodies)) return "names too many bodies";
  if (!within(meta.parameter_names.size(), kMaxLiveParameters)) return "names too many parameters";
  if (meta.parameter_values.size() != meta.parameter_names.size()) {
    return "has not one value for each parameter";
  }
  if (!within(meta.value_names.size(), kMaxExerciseValues)) return "names too many values";
  const std::size_t results = meta.result_names.size();
  if (meta.result_labels.size() != results || meta.result_units.size() != results ||
      meta.result_factors.size() != results || meta.result_decimals.size() != results) {
    return "has not one label, unit, factor and number of decimals for each result";
  }
  if (!(meta.period_s >= kLeastPeriod_s && meta.period_s <= kMostPeriod_s)) {
    return fmt::format("has a period of {} s; {} to {} are possible", meta.period_s, kLeastPeriod_s,
                       kMostPeriod_s);
  }
  return {};
}

bool isPlausible(const TickRecord& record) {
  return std::isfinite(record.time_s) && record.contacts_dropped >= 0 &&
         record.contacts_dropped <= kMostContactsDropped;
}

bool fits(const TickRecord& record, const RecordingMeta& meta) {
  const auto axes = static_cast<std::int64_t>(meta.axis_names.size());
  const auto or_none = [axes](const auto& array) {
    return array.size() == 0 || array.size() == axes;
  };
  const auto within = [](std::int64_t n, std::size_t most) {
    return n >= 0 && n <= static_cast<std::int64_t>(most);
  };
  const auto commands = within(record.command_count, kMaxCommands);
  for (std::int32_t i = 0; commands && i < record.command_count; ++i) {
    if (!or_none(record.commands[i].aim)) return false;
  }
  return commands && isPlausible(record) && record.q_m.size() == axes &&
         record.sent.size() == axes && or_none(record.intention) &&
         or_none(record.patient_effort) && or_none(record.qd_mf) && or_none(record.q_s) &&
         or_none(record.qd_s) && or_none(record.closure) && or_none(record.f_s) &&
         or_none(record.coupling) && or_none(record.phi) && or_none(record.damping) &&
         or_none(record.tank) && or_none(record.tank_effort) && or_none(record.rendered) &&
         or_none(record.effort_limit) && or_none(record.exercise.effort) &&
         within(record.theta.size(), meta.joint_names.size()) &&
         within(record.body_count, meta.body_names.size()) &&
         within(record.parameter_count, meta.parameter_names.size()) &&
         within(record.exercise.value_count, meta.value_names.size()) &&
         within(record.exercise.event_count, kMaxExerciseEvents) &&
         within(record.contact_count, kMaxContacts) && within(record.placements.count, kMaxBodies);
}

}  // namespace wholehand::recording
