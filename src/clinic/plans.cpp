#include "clinic/plans.hpp"

#include "clinic/rows.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <utility>
#include <vector>

namespace wholehand::clinic {
namespace {

constexpr std::size_t kMostItems = 20;
constexpr double kMostMinutes = 120.0;

}  // namespace

Plan capped(Plan plan, const PersonLimits& limits) {
  for (PlanItem& item : plan) {
    for (auto& [name, value] : item.parameters) value = limits.lowered(name, value);
  }
  return plan;
}

Parameters Plans::readParameters(const Json& values, const std::string& field) const {
  Parameters out;
  if (values.is_null()) return out;
  if (!values.is_object()) throw badValue(field, field + " is no object of names and numbers");
  const StationScene scene = station_.scene();
  for (const auto& [name, value] : values.items()) {
    const std::string key = fmt::format("{}.{}", field, name);
    const auto known = records_.presets().bounds.find(name);
    if (known == records_.presets().bounds.end())
      throw badValue(field, "an unknown parameter is named");
    const auto heard = scene.bounds.find(name);
    const auto& bounds = heard != scene.bounds.end() ? heard->second : known->second;
    out[name] = numberOf(value, key, bounds[0], bounds[1], {});
  }
  return out;
}

Plan Plans::readPlan(const Json& items, const std::string& field,
                     const PersonLimits& limits) const {
  if (!items.is_array() || items.size() > kMostItems) {
    throw badValue(field, fmt::format("{} is no list of at most {} items", field, kMostItems));
  }
  Plan plan;
  for (const Json& row : items) {
    const std::string at = fmt::format("{}[{}]", field, plan.size());
    if (!row.is_object()) throw badValue(at, at + " is no item");
    PlanItem item;
    const Json exercise = row.value("exercise", Json());
    const ExerciseFacts* facts =
        exercise.is_string() ? records_.presets().exercise(exercise.get<std::string>()) : nullptr;
    if (facts == nullptr) throw badValue(at + ".exercise", at + ".exercise is not one of ours");
    item.exercise = facts->id;
    const double level = numberOf(row.value("level", Json(1)), at + ".level", 1, facts->levels, {});
    if (level != std::floor(level)) throw badValue(at + ".level", at + ".level is no whole number");
    item.level = static_cast<int>(level);
    item.minutes =
        numberOf(row.value("minutes", Json(10)), at + ".minutes", 1, kMostMinutes, "min");
    // Help and parameters; effort limits must not exceed those of the person.
    const Json help = row.value("help", Json("some"));
    if (help != "full" && help != "some" && help != "none") {
      throw badValue(at + ".help", at + ".help must be full, some or none");
    }
    item.help = help;
    item.parameters = readParameters(row.value("parameters", Json()), at + ".parameters");
    for (const auto& [name, value] : item.parameters) {
      const auto has = [&name = name](const std::vector<std::string>& names) {
        return std::find(names.begin(), names.end(), name) != names.end();
      };
      if (!has(records_.presets().device) && !has(facts->parameters)) {
        throw badValue(fmt::format("{}.parameters.{}", at, name),
                       fmt::format("{} has no parameter {}", item.exercise, name));
      }
      if (limits.exceeds(name, value)) {
        throw badValue(fmt::format("{}.parameters.{}", at, name),
                       fmt::format("{} = {} is above the person's limit, {}; raise that first",
                                   name, value, *limits.of(name)));
      }
    }
    plan.push_back(std::move(item));
  }
  return plan;
}

Parameters Plans::settingsOf(const std::optional<std::int64_t>& patient, const Json& changed) {
  std::string preset = records_.presets().force.front().id;
  Parameters own = changed.get<Parameters>();
  if (patient) {
    Statement row =
        records_.db().query("SELECT preset, parameters FROM patient WHERE id = ?", *patient);
    if (!row.step()) throw notFound(fmt::format("there is no patient {}", *patient));
    refuseDamaged(records_.db(), "patient", *patient, fmt::format("patient {}", *patient));
    preset = row.text(0);
    own.merge(Json::parse(row.text(1)).get<Parameters>());
  }
  const ForcePreset* force = records_.presets().forceOf(preset);
  if (force == nullptr) throw badValue("preset", "the patient's preset is no longer offered");
  const StationScene scene = station_.scene();
  for (const auto& [name, value] : force->parameters) {
    const auto heard = scene.bounds.find(name);
    const bool has = heard != scene.bounds.end();
    if (scene.received && !has) continue;  // the device has no such axis
    own.emplace(name, has ? std::clamp(value, heard->second[0], heard->second[1]) : value);
  }
  return own;
}

PersonLimits Plans::limitsAmong(const Parameters& settings) const {
  PersonLimits limits;
  for (const std::string& name : records_.presets().limits) {
    if (const auto set = settings.find(name); set != settings.end()) limits.set(name, set->second);
  }
  return limits;
}

Json Plans::presets(Call&) {
  const Presets& shipped = records_.presets();
  Json bounds = shipped.bounds;
  for (const auto& [name, pair] : station_.scene().bounds) {
    if (bounds.contains(name)) bounds[name] = pair;
  }
  const Json course = {{"weeks", shipped.course_weeks},
                       {"visits_a_week", shipped.course_visits_a_week}};
  return {{"force", shipped.force},         {"plans", shipped.plans}, {"goals", shipped.goals},
          {"exercises", shipped.exercises}, {"bounds", bounds},       {"course", course}};
}

}  // namespace wholehand::clinic
