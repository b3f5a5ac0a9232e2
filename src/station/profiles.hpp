#pragma once

#include "loop/core/expected.hpp"
#include "vocabulary/backend.hpp"

#include <cstdint>
#include <map>
#include <string>
#include <utility>
#include <vector>

namespace wholehand {

/// A therapist's settings for one patient.
struct Profile {
  std::string name;      ///< name of the patient and of the file: letters, digits, '-' and '_'
  std::string device;    ///< name in the device file
  std::string side;      ///< "right" or "left"
  std::string hand;      ///< file of the hands folder without .toml; gives side and size
  std::string exercise;  ///< file of the exercises folder, without .toml
  int level = 1;
  Help help = Help::kUnspecified;  ///< help that the pages show the player; kUnspecified: not
                                   ///< in the file
  std::map<std::string, double> parameters;  ///< live parameters by name, in their own units
};

/// A folder of profiles, one TOML file each, which people may read and edit. Not real-time safe.
class Profiles {
 public:
  /// @param folder created with the first profile; empty: no profiles are kept
  explicit Profiles(std::string folder) : folder_(std::move(folder)) {}

  [[nodiscard]] bool kept() const { return !folder_.empty(); }
  /// Names, sorted; other files are skipped.
  [[nodiscard]] std::vector<std::string> list() const;
  /// Writes a profile atomically; replaces one of the same name.
  [[nodiscard]] Expected<Done> save(const Profile& profile) const;
  /// Reads a profile, or returns every fault of the file.
  [[nodiscard]] Expected<Profile> load(const std::string& name) const;

 private:
  [[nodiscard]] std::string pathOf(const std::string& name) const;
  std::string folder_;
};

/// True for a valid profile name: 1 to 60 letters, digits, '-' and '_'.
[[nodiscard]] bool isProfileName(const std::string& name);

}  // namespace wholehand
