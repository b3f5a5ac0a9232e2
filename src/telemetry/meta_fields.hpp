#pragma once

#include "telemetry/recording.hpp"

namespace wholehand::recording {

/// Every field of a description but its files: archive(name, value) reads or writes one. Ends with
/// false at the first that fails. Private to telemetry.
template <class Archive, class Meta>
bool visitMeta(Archive&& a, Meta& m) {
  return a("created_utc", m.created_utc) && a("git_version", m.git_version) &&
         a("title", m.title) && a("profile", m.profile) && a("seed", m.seed) &&
         a("period_s", m.period_s) && a("engine", m.engine) &&
         a("simulated_clock", m.simulated_clock) && a("uncertified", m.uncertified) &&
         a("paper", m.paper) && a("models_changed", m.models_changed) &&
         a("simulated_device", m.simulated_device) && a("passport", m.passport) &&
         a("axis_names", m.axis_names) && a("axis_units", m.axis_units) &&
         a("effort_limits", m.effort_limits) && a("lever_arms_m", m.lever_arms_m) &&
         a("encoder_step", m.encoder_step) && a("armed_position", m.armed_position) &&
         a("joint_names", m.joint_names) && a("body_names", m.body_names) &&
         a("capsule_names", m.capsule_names) && a("game_slots", m.game_slots) &&
         a("exercise", m.exercise) && a("level", m.level) &&
         a("parameter_names", m.parameter_names) && a("parameter_values", m.parameter_values) &&
         a("value_names", m.value_names) && a("event_names", m.event_names) &&
         a("result_names", m.result_names) && a("result_labels", m.result_labels) &&
         a("result_units", m.result_units) && a("result_factors", m.result_factors) &&
         a("result_decimals", m.result_decimals);
}

}  // namespace wholehand::recording
