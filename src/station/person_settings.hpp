#pragma once

#include "station/profiles.hpp"
#include "vocabulary/backend.hpp"
#include "vocabulary/person_limits.hpp"

#include <cstdint>
#include <map>
#include <string>
#include <vector>

namespace wholehand {

/// Settings of the person at the device: live parameters and help that people have set. They stay
/// until another person or hand is loaded. One thread at a time.
class PersonSettings {
 public:
  /// Values by parameter name that replace the values of the files.
  using Values = std::map<std::string, double>;

  explicit PersonSettings(const Values& first) { put(first, 0, set_); }

  /// Sets a live parameter.
  /// @param asked number of the order, here and in setHelp()
  void set(const std::string& name, double value, std::uint64_t asked) {
    set_[name] = {value, asked};
  }
  void setHelp(Help help, std::uint64_t asked);

  /// Value set for the person if it is in the range of the parameter, else the file's value. An
  /// effort limit outside its range is clamped, so it never exceeds the file's own limit.
  [[nodiscard]] double valueOf(const PublishedParameter& parameter) const;
  /// Effort limits in force.
  [[nodiscard]] PersonLimits limits(const std::vector<PublishedParameter>& parameters) const;
  [[nodiscard]] Help help() const { return help_; }
  /// Number of times that a person or a hand was loaded.
  [[nodiscard]] std::uint64_t person() const { return person_; }

  struct Change {
    const Profile* profile = nullptr;  ///< its values hold from now on; null: the values of `first`
    std::uint64_t asked = 0;
    bool visit = false;  ///< the person comes from the clinic's records
    bool may_raise_limits = false;
  };
  /// Removes the values and the help of the earlier person. Values that were set after the order to
  /// change (by order number) stay; in a visit only a lowered effort limit stays, because other
  /// values may have been meant for the earlier person. A lowered effort limit rises only if
  /// Change::may_raise_limits is set.
  /// @param first values of parameters that the profile does not name
  /// @param parameters published parameters of the models loaded until now
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
  Help help_ = Help::kUnspecified;
  std::uint64_t help_asked_ = 0, person_ = 0;
};

}  // namespace wholehand
