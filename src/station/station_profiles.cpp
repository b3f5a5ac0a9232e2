// A therapist's settings per patient, kept across restarts: on the station's main thread.
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

OrderReply Station::Core::saveProfile(const Order& order) {
  if (!models_.exercise) {
    return refused(Refusal::kOther, "a profile needs an exercise; load one first");
  }
  Profile profile;
  profile.name = order.name;
  profile.device = models_.device.name;
  profile.side = sideName(models_.hand);
  profile.hand = stem(models_.files.hand);
  profile.exercise = stem(models_.files.exercise);
  profile.level = models_.files.level;
  {
    const std::lock_guard lock(mutex_);
    profile.help = help_;
    for (const PublishedParameter& parameter : scene_->parameters) {
      const auto asked = asked_parameters_.find(parameter.name);
      const bool set = asked != asked_parameters_.end();
      profile.parameters[parameter.name] = set ? asked->second : parameter.initial;
    }
  }
  const WaitingFor disk("the disk: a profile");
  if (auto saved = profiles_.save(profile); !saved) {
    return refused(Refusal::kOther, format(saved.errors()));
  }
  say("profile " + profile.name + " is saved");
  profile_ = profile.name;
  publishScene(record_path_);
  return {true, ""};
}

// Only while disarmed: a person must not suddenly feel another person's limits.
OrderReply Station::Core::loadProfile(const Order& order) {
  if (live_) return refused(Refusal::kArmedAlready, "it is armed: stop, then load the profile");
  const WaitingFor disk("the disk: a profile");
  const Expected<Profile> profile = profiles_.load(order.name);
  if (!profile) return refused(Refusal::kUnknownProfile, format(profile.errors()));
  if (profile->device != models_.device.name) {
    return refused(Refusal::kOtherProfile,
                   fmt::format("the profile {} is for the device {}, this is {}", profile->name,
                               profile->device, models_.device.name));
  }
  Order load;
  load.type = OrderType::kLoadExercise;
  load.name = profile->exercise;
  load.hand = profile->hand;
  load.level = profile->level;
  ModelFiles files;
  if (OrderReply known = filesOf(load, files); !known.accepted) {
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
  OrderReply reply = loadExercise(load);
  if (!reply.accepted) return reply;
  {
    const std::lock_guard lock(mutex_);
    asked_parameters_ = profile->parameters;
    help_ = profile->help;
  }
  profile_ = profile->name;
  publishScene("");
  return reply;
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
