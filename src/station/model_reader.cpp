#include "station/model_reader.hpp"

#include "exercises/load_exercise.hpp"
#include "loop/runtime/interrupt_scope.hpp"

#include <algorithm>
#include <filesystem>
#include <system_error>
#include <utility>

namespace wholehand {

namespace fs = std::filesystem;

std::vector<std::string> stemsIn(const std::string& folder) {
  std::vector<std::string> stems;
  std::error_code error;
  for (fs::directory_iterator it(folder, error), end; !error && it != end; it.increment(error)) {
    if (it->path().extension() == ".toml") stems.push_back(it->path().stem().string());
  }
  std::sort(stems.begin(), stems.end());
  return stems;
}

Profile profileOf(const Models& models) {
  Profile profile;
  profile.device = models.device.name;
  profile.side = models.hand.side == Side::kLeft ? "left" : "right";
  profile.hand = fs::path(models.files.hand).stem().string();
  profile.exercise = models.exercise ? fs::path(models.files.exercise).stem().string() : "";
  profile.level = models.files.level;
  return profile;
}

OrderReply ModelReader::find(const Names& names, ModelFiles& files) const {
  if (!names.exercise.empty()) {
    const auto known = listExercises(config_ + "/exercises");
    const auto found = std::find_if(known.begin(), known.end(), [&](const ExerciseFile& f) {
      return f.name == names.exercise;
    });
    if (found == known.end()) {
      return refused(Refusal::kUnknownExercise, "there is no exercise \"" + names.exercise + "\"");
    }
    files.exercise = found->path;
    files.level = 1;
  }
  if (!names.hand.empty()) {
    const auto known = stemsIn(config_ + "/hands");
    if (std::find(known.begin(), known.end(), names.hand) == known.end()) {
      return refused(Refusal::kUnknownHand, "there is no hand \"" + names.hand + "\"");
    }
    files.hand = config_ + "/hands/" + names.hand + ".toml";
  }
  if (!names.hand_file.empty()) files.hand = (fs::path(visit_hands_) / names.hand_file).string();
  if (names.prescription_file) {
    const std::string& name = *names.prescription_file;
    files.prescription = name.empty() ? "" : (fs::path(visit_hands_) / name).string();
  }
  if (names.level > 0) files.level = names.level;
  return {true, ""};
}

OrderReply ModelReader::read(const ModelFiles& files, Models& models) const {
  const WaitingFor disk("the disk: what is to be loaded");
  Expected<Models> read = loadModels(files);
  if (!read) return refused(Refusal::kCannotLoad, format(read.errors()));
  const auto gains = checkGains(*read, rig_.period_s, rig_.measured);
  if (!gains) return refused(Refusal::kCannotLoad, format(gains.errors()));
  if (Diagnostics no = refuseToRender(*gains, rig_); !no.empty()) {
    return refused(Refusal::kNotStable, format(no));
  }
  models = std::move(*read);
  return {true, ""};
}

}  // namespace wholehand
