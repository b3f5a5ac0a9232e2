#include "clinic/limits.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <set>

namespace wholehand::clinic {
namespace {

constexpr std::size_t kMostLimits = 16, kLongestAxis = 40;
constexpr double kFurthest_m = 1.0, kFurthest_rad = 7.0;

bool isAxisName(const std::string& name) {
  return !name.empty() && name.size() <= kLongestAxis &&
         std::all_of(name.begin(), name.end(), [](char c) {
           return (c >= 'a' && c <= 'z') || c == '_' || (c >= '0' && c <= '9');
         });
}

/// The key that this limit has: "within_m" or "within_rad".
std::string rangeKeyOf(const Json& limit, const std::string& field) {
  const bool along = limit.contains("within_m");
  if (along == limit.contains("within_rad")) {
    throw badValue(field, field + " has either within_m or within_rad");
  }
  return along ? "within_m" : "within_rad";
}

}  // namespace

Json readLimits(const Json& limits, const std::string& field) {
  if (!limits.is_array() || limits.size() > kMostLimits) {
    throw badValue(field, fmt::format("{} is a list of at most {} limits", field, kMostLimits));
  }
  Json out = Json::array();
  std::set<std::string> named;
  for (const Json& limit : limits) {
    const std::string at = fmt::format("{}.{}", field, out.size());
    const Json axis = limit.is_object() ? limit.value("axis", Json()) : Json();
    if (!axis.is_string() || !isAxisName(axis)) {
      throw badValue(at + ".axis", at + ".axis names an axis of the device, as finger_flexion");
    }
    if (!named.insert(axis).second) {
      throw badValue(at + ".axis", fmt::format("{} has a limit already", axis.get<std::string>()));
    }
    const std::string key = rangeKeyOf(limit, at);
    const Json& range = limit[key];
    const bool along = key == "within_m";
    const double furthest = along ? kFurthest_m : kFurthest_rad;
    if (!range.is_array() || range.size() != 2)
      throw badValue(at, at + "." + key + " has two ends");
    const double lower =
        numberOf(range[0], at + "." + key, -furthest, furthest, along ? "m" : "rad");
    const double upper =
        numberOf(range[1], at + "." + key, -furthest, furthest, along ? "m" : "rad");
    if (!(lower < upper))
      throw badValue(at, fmt::format("{}.{} = [{}, {}]: ends cross", at, key, lower, upper));
    out.push_back({{"axis", axis}, {key, {lower, upper}}});
  }
  return out;
}

std::vector<LimitText> limitTexts(const Json& limits) {
  std::vector<LimitText> out;
  for (const Json& limit : limits) {
    const bool along = limit.contains("within_m");
    const Json& range = limit[along ? "within_m" : "within_rad"];
    out.push_back({limit["axis"], along, range[0], range[1]});
  }
  return out;
}

}  // namespace wholehand::clinic
