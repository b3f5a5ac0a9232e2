#pragma once

#include "server/backend.hpp"
#include "station/profiles.hpp"

#include <cstdint>
#include <map>
#include <string>
#include <vector>

namespace wholehand {

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

  /// The file's value unless a person set one that is in the range.
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
  static void put(const Values& values, std::uint64_t asked, std::map<std::string, Setting>& in);

  std::map<std::string, Setting> set_;
  Help help_ = Help::kUnsaid;
  std::uint64_t help_asked_ = 0, person_ = 0;
};

}  // namespace wholehand
