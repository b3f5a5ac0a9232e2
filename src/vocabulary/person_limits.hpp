#pragma once

#include <algorithm>
#include <map>
#include <optional>
#include <string>

namespace wholehand {

/// Effort limits of a person, by the name of their live parameter and in its unit (N). The rule for
/// all of them: a limit falls whenever something lower is asked, and rises only where a person may
/// raise it. LiveParameter::bounds_effort says which parameters are limits.
class PersonLimits {
 public:
  void set(const std::string& name, double limit) { limits_[name] = limit; }
  /// The limit of this name; none for other parameters.
  [[nodiscard]] std::optional<double> of(const std::string& name) const {
    const auto limit = limits_.find(name);
    return limit == limits_.end() ? std::nullopt : std::optional(limit->second);
  }
  /// The lower of `value` and the limit of this name; `value` if there is none.
  [[nodiscard]] double lowered(const std::string& name, double value) const {
    return std::min(value, of(name).value_or(value));
  }
  /// True when `value` is above the limit of this name.
  [[nodiscard]] bool exceeds(const std::string& name, double value) const {
    return lowered(name, value) < value;
  }

  [[nodiscard]] auto begin() const { return limits_.begin(); }
  [[nodiscard]] auto end() const { return limits_.end(); }

 private:
  std::map<std::string, double> limits_;
};

}  // namespace wholehand
