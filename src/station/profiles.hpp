#pragma once

#include "core/expected.hpp"
#include "server/backend.hpp"

#include <map>
#include <string>
#include <utility>
#include <vector>

namespace wholehand {

/// What a therapist has set for one patient.
struct Profile {
  std::string name;      ///< of the patient, as its file: letters, digits, '-' and '_'
  std::string device;    ///< of the device file
  std::string side;      ///< "right" or "left"
  std::string hand;      ///< file of the hands folder, without .toml: side and size
  std::string exercise;  ///< file of the exercises folder, without .toml
  int level = 1;
  Help help = Help::kUnsaid;                 ///< what pages do for the player; kUnsaid: no such key
  std::map<std::string, double> parameters;  ///< live ones, by name, in their own units
};

/// A folder of profiles, one TOML file each, which a person may read and mend. Not real-time safe.
class Profiles {
 public:
  /// @param folder made when the first profile is; empty: none are kept
  explicit Profiles(std::string folder) : folder_(std::move(folder)) {}

  [[nodiscard]] bool kept() const { return !folder_.empty(); }
  /// Names, sorted. Files of another kind are left out.
  [[nodiscard]] std::vector<std::string> list() const;
  /// Replaces the one of this name; nothing half-written.
  [[nodiscard]] Expected<Done> save(const Profile& profile) const;
  /// Every fault of the file at once.
  [[nodiscard]] Expected<Profile> load(const std::string& name) const;

 private:
  [[nodiscard]] std::string pathOf(const std::string& name) const;
  std::string folder_;
};

/// Whether it may be the name of a profile: 1 to 60 letters, digits, '-' and '_'.
[[nodiscard]] bool isProfileName(const std::string& name);

}  // namespace wholehand
