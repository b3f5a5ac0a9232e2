#include "station/scene_facts.hpp"

#include "loop/control/adaptive_damping.hpp"
#include "loop/renderer/live_settings.hpp"

#include <string>
#include <vector>

namespace wholehand {
namespace {

/// Puts the parameters of the person's arm and hand into the person's groups.
ParameterGroup groupOf(const std::string& name, ParameterGroup usual) {
  if (name.starts_with("reach_")) return ParameterGroup::kPatient;
  return name.starts_with("fingers_") ? ParameterGroup::kHand : usual;
}

void publish(const std::vector<LiveParameter>& parameters, ParameterGroup group,
             SceneFacts& facts) {
  for (const LiveParameter& p : parameters) {
    facts.parameters.push_back({p.name, groupOf(p.name, group), p.unit, p.lower, p.upper, p.value,
                                p.rate_per_s, p.bounds_effort});
  }
}

}  // namespace

SceneFacts sceneFacts(const Models& models, double period_s) {
  SceneFacts facts;
  facts.hand = models.hand;
  facts.device = models.device;
  facts.scene = models.scene;
  facts.patient_name = models.patient.name;
  facts.period_s = period_s;
  // The renderer's own parameters come first, as in TickRecord::parameters.
  publish(LiveSettings(models.device, makeAdaptiveDamping(models.device, models.rendering))
              .parameters(),
          ParameterGroup::kPatient, facts);
  if (models.exercise) {
    const ExerciseDescription& exercise = models.exercise->description();
    facts.exercise_name = exercise.name;
    facts.exercise_json = exercise.json;
    facts.level = exercise.level;
    facts.levels = exercise.levels;
    facts.value_names = exercise.value_names;
    facts.event_names = exercise.event_names;
    facts.panel = models.exercise_panel;
    publish(exercise.parameters, ParameterGroup::kExercise, facts);
  }
  return facts;
}

}  // namespace wholehand
