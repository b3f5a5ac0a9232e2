#pragma once

#include "clinic/records.hpp"
#include "clinic/station_client.hpp"
#include "vocabulary/person_limits.hpp"

#include <cstdint>
#include <optional>
#include <string>

namespace wholehand::clinic {

/// The plan with effort limits lowered to those of the person.
[[nodiscard]] Plan capped(Plan plan, const PersonLimits& limits);

/// Reads plans and parameters of requests. It checks them against the bounds that the station
/// reports, or against the shipped ones. It also computes the settings and limits that apply to
/// a person.
class Plans {
 public:
  Plans(Records& records, const Station& station) : records_(records), station_(station) {}

  [[nodiscard]] Parameters readParameters(const Json& values, const std::string& field) const;
  [[nodiscard]] Plan readPlan(const Json& items, const std::string& field,
                              const PersonLimits& limits) const;
  /// Settings of a person. Later sources override earlier ones: the force preset, the person's own
  /// values, the values set in the open visit. Values outside narrower bounds of the station are
  /// clamped.
  [[nodiscard]] Parameters settingsOf(const std::optional<std::int64_t>& patient,
                                      const Json& changed = Json::object());
  /// Those of the settings that bound efforts.
  [[nodiscard]] PersonLimits limitsAmong(const Parameters& settings) const;
  [[nodiscard]] PersonLimits limitsOf(const std::optional<std::int64_t>& patient,
                                      const Json& changed = Json::object()) {
    return limitsAmong(settingsOf(patient, changed));
  }
  Json presets(Call& call);

 private:
  Records& records_;
  const Station& station_;
};

}  // namespace wholehand::clinic
