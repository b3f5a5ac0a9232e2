// A therapist's settings per patient, kept across restarts: on the station's main thread.
#include "renderer/live_settings.hpp"
#include "runtime/interrupt_scope.hpp"
#include "station/scene_facts.hpp"
#include "station/station_core.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <filesystem>
#include <utility>

namespace wholehand {
namespace {

std::string stem(const std::string& path) {
  return std::filesystem::path(path).stem().string();
}

std::string sideName(const HandModel& hand) {
  return hand.side == Side::kLeft ? "left" : "right";
}

}  // namespace

Profile Station::Core::profileOf(const Models& models) {
  Profile profile;
  profile.device = models.device.name;
  profile.side = sideName(models.hand);
  profile.hand = stem(models.files.hand);
  profile.exercise = models.exercise ? stem(models.files.exercise) : "";
  profile.level = models.files.level;
  return profile;
}

Profile Station::Core::profileNow() const {
  Profile profile = loaded_;
  profile.help = help_;
  for (const PublishedParameter& parameter : scene_->parameters) {
    profile.parameters[parameter.name] = valueOf(parameter);
  }
  return profile;
}

// Of the earlier person nothing stays: neither values nor help nor the right to rest. What was set
// after the order to change was given stays. A limit goes up only for who may set it.
void Station::Core::changePerson(const Task& task, const Profile* profile) {
  ++person_;
  rest_ending_ = 0;
  if (help_asked_ < task.asked) help_ = profile != nullptr ? profile->help : Help::kUnsaid;
  std::map<std::string, Setting> next;
  if (profile != nullptr) {
    for (const auto& [name, value] : profile->parameters) next[name] = {value, task.asked};
  }
  for (const PublishedParameter& parameter : scene_->parameters) {
    const auto set = asked_parameters_.find(parameter.name);
    const auto found = next.find(parameter.name);
    const double coming = found == next.end() ? parameter.initial : found->second.value;
    const bool later = set != asked_parameters_.end() && set->second.asked > task.asked;
    const bool keeps_limit = isEffortLimit(parameter.name) && !task.order.may_raise_limits &&
                             valueOf(parameter) < coming;
    if (later) {
      next[parameter.name] = set->second;
    } else if (keeps_limit) {
      next[parameter.name] = {valueOf(parameter), task.asked};
    }
  }
  asked_parameters_ = std::move(next);
}

OrderReply Station::Core::saveProfile(const Task& task) {
  Profile profile = task.profile;
  profile.name = task.order.name;
  if (profile.exercise.empty()) {
    return refused(Refusal::kOther, "a profile needs an exercise; load one first");
  }
  const WaitingFor disk("the disk: a profile");
  if (auto saved = profiles_.save(profile); !saved) {
    return refused(Refusal::kOther, format(saved.errors()));
  }
  say("profile " + profile.name + " is saved");
  if (task.person == person_) profile_ = profile.name;
  publishScene(record_path_);
  return {true, ""};
}

// Only while disarmed: a person must not suddenly feel another person's limits.
OrderReply Station::Core::loadProfile(const Task& task) {
  if (live_) return refused(Refusal::kArmedAlready, "it is armed: stop, then load the profile");
  const WaitingFor disk("the disk: a profile");
  const Expected<Profile> profile = profiles_.load(task.order.name);
  if (!profile) return refused(Refusal::kUnknownProfile, format(profile.errors()));
  if (profile->device != models_.device.name) {
    return refused(Refusal::kOtherProfile,
                   fmt::format("the profile {} is for the device {}, this is {}", profile->name,
                               profile->device, models_.device.name));
  }
  Order named;
  named.name = profile->exercise;
  named.hand = profile->hand;
  named.level = profile->level;
  ModelFiles files;
  if (OrderReply known = filesOf(named, files); !known.accepted) {
    known.reason = fmt::format("the profile {}: {}", profile->name, known.reason);
    return known;
  }
  const Expected<Models> models = loadModels(files);
  if (!models) return refused(Refusal::kCannotLoad, format(models.errors()));
  if (sideName(models->hand) != profile->side) {
    return refused(
        Refusal::kOtherProfile,
        fmt::format("the profile {} is for a {} hand, its hand {} is a {} one", profile->name,
                    profile->side, profile->hand, sideName(models->hand)));
  }
  if (OrderReply fits = refuseParameters(*profile, *models); !fits.accepted) return fits;
  return this->load(task, files, &*profile);
}

OrderReply Station::Core::refuseParameters(const Profile& profile, const Models& models) const {
  const SceneFacts facts = sceneFacts(models, config_.rig.period_s);
  for (const auto& parameter : profile.parameters) {
    const std::string& name = parameter.first;  // clang 14 cannot capture structured bindings
    const double value = parameter.second;
    const auto known = std::find_if(facts.parameters.begin(), facts.parameters.end(),
                                    [&](const PublishedParameter& p) { return p.name == name; });
    if (known == facts.parameters.end()) {
      return refused(Refusal::kUnknownParameter,
                     fmt::format("the profile {} sets {}, which the exercise {} does not have",
                                 profile.name, name, profile.exercise));
    }
    if (!(value >= known->lower && value <= known->upper)) {
      return refused(
          Refusal::kOutOfRange,
          fmt::format("the profile {} sets {} = {}, which must be in [{}, {}] {}", profile.name,
                      name, value, known->lower, known->upper, known->unit));
    }
  }
  return {true, ""};
}

}  // namespace wholehand
