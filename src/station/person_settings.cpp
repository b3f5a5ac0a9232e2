#include "station/person_settings.hpp"

#include <algorithm>
#include <utility>

namespace wholehand {

void PersonSettings::put(const Values& values, std::uint64_t asked,
                         std::map<std::string, Setting>& in) {
  for (const auto& [name, value] : values) in[name] = {value, asked};
}

void PersonSettings::setHelp(Help help, std::uint64_t asked) {
  help_ = help;
  help_asked_ = asked;
}

double PersonSettings::inRange(const PublishedParameter& parameter, double value) {
  if (parameter.bounds_effort) return std::clamp(value, parameter.lower, parameter.upper);
  return value >= parameter.lower && value <= parameter.upper ? value : parameter.initial;
}

double PersonSettings::valueOf(const PublishedParameter& parameter) const {
  const auto set = set_.find(parameter.name);
  return set == set_.end() ? parameter.initial : inRange(parameter, set->second.value);
}

PersonLimits PersonSettings::limits(const std::vector<PublishedParameter>& parameters) const {
  PersonLimits limits;
  for (const PublishedParameter& parameter : parameters) {
    if (parameter.bounds_effort) limits.set(parameter.name, valueOf(parameter));
  }
  return limits;
}

void PersonSettings::changePerson(const Change& change, const Values& first,
                                  const std::vector<PublishedParameter>& parameters) {
  std::map<std::string, Setting> next;
  put(first, change.asked, next);
  if (change.profile != nullptr) put(change.profile->parameters, change.asked, next);
  const PersonLimits until_now = limits(parameters);
  for (const PublishedParameter& parameter : parameters) {
    const auto set = set_.find(parameter.name);
    const auto found = next.find(parameter.name);
    const double coming =
        found == next.end() ? parameter.initial : inRange(parameter, found->second.value);
    const auto limit = until_now.of(parameter.name);
    const bool later = set != set_.end() && set->second.asked > change.asked;
    if (later && (!change.visit || (limit && *limit <= coming))) {
      next[parameter.name] = set->second;
    } else if (!change.may_raise_limits && until_now.exceeds(parameter.name, coming)) {
      next[parameter.name] = {until_now.lowered(parameter.name, coming), change.asked};
    }
  }
  set_ = std::move(next);
  ++person_;
  if (help_asked_ < change.asked || change.visit) {
    help_ = change.profile != nullptr ? change.profile->help : Help::kUnspecified;
  }
}

}  // namespace wholehand
