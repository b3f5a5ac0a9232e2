#pragma once

#include "clinic/records.hpp"
#include "clinic/station.hpp"

#include <cstdint>
#include <optional>
#include <string>

namespace wholehand::clinic {

/// A plan as the pages have it.
[[nodiscard]] Json toJson(const Plan& plan);
[[nodiscard]] Plan planFrom(const std::string& json);
/// The plan without effort limits above those of the person.
[[nodiscard]] Plan capped(Plan plan, const Parameters& limits);

/// Reads plans and parameters of requests, within the station's bounds of what it has, else the
/// shipped ones; says which limits hold for a person.
class Plans {
 public:
  Plans(Records& records, const Station& station) : records_(records), station_(station) {}

  [[nodiscard]] Parameters readParameters(const Json& values, const std::string& field) const;
  [[nodiscard]] Plan readPlan(const Json& items, const std::string& field,
                              const Parameters& limits) const;
  /// Force preset, then the person's own, then what was set in the open visit; what the station has
  /// narrower bounds for is clamped.
  [[nodiscard]] Parameters limitsOf(const std::optional<std::int64_t>& patient,
                                    const Json& changed = Json::object());
  Json presets(Call& call);

 private:
  Records& records_;
  const Station& station_;
};

}  // namespace wholehand::clinic
