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
  Help help = Help::kUnsaid;                 ///< help of the pages for the player; kUnsaid: no such
                                             ///< key
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
  /// Writes or replaces the profile of this name, atomically.
  [[nodiscard]] Expected<Done> save(const Profile& profile) const;
  /// Reads a profile, or returns every fault of the file.
  [[nodiscard]] Expected<Profile> load(const std::string& name) const;

 private:
  [[nodiscard]] std::string pathOf(const std::string& name) const;
  std::string folder_;
};

/// True for a valid profile name: 1 to 60 letters, digits, '-' and '_'.
[[nodiscard]] bool isProfileName(const std::string& name);

/// What holds for the person at the device: live parameters and help that people set. It stays
/// until another person or hand is loaded. One thread at a time.
class PersonSettings {
 public:
  /// Values by name, in place of the files' own.
  using Values = std::map<std::string, double>;

  explicit PersonSettings(const Values& first) { put(first, 0, set_); }

  /// @param asked number of the order that sets it; likewise below
  void set(const std::string& name, double value, std::uint64_t asked) {
    set_[name] = {value, asked};
  }
  void setHelp(Help help, std::uint64_t asked);

  /// The file's value unless a person set one that is in the range. An effort limit outside of it
  /// is the nearest within: the file's own is the greatest.
  [[nodiscard]] double valueOf(const PublishedParameter& parameter) const;
  [[nodiscard]] Help help() const { return help_; }
  /// Counts persons and hands that were loaded.
  [[nodiscard]] std::uint64_t person() const { return person_; }

  struct Change {
    const Profile* profile = nullptr;  ///< whose values hold from then on; null: the first ones
    std::uint64_t asked = 0;
    bool visit = false;  ///< the clinic's records name the person
    bool may_raise_limits = false;
  };
  /// Of the earlier person nothing stays, neither values nor help. What was set after the order to
  /// change was given stays; in a visit, only a lower limit, since it may have been meant for the
  /// person before. A limit goes up only for who may set it.
  /// @param first values where the profile names none
  /// @param parameters as published for what was loaded until now
  void changePerson(const Change& change, const Values& first,
                    const std::vector<PublishedParameter>& parameters);

 private:
  struct Setting {
    double value = 0.0;
    std::uint64_t asked = 0;
  };
  static double inRange(const PublishedParameter& parameter, double value);
  static void put(const Values& values, std::uint64_t asked, std::map<std::string, Setting>& in);

  std::map<std::string, Setting> set_;
  Help help_ = Help::kUnsaid;
  std::uint64_t help_asked_ = 0, person_ = 0;
};

}  // namespace wholehand
