#pragma once

#include "core/expected.hpp"

#include <nlohmann/json_fwd.hpp>

#include <functional>
#include <string>

namespace wholehand {

/// Collects the data of a report page from a recording of any length, or from a black box, in one
/// pass: description, scene, a few hundred states, the extremes of all series, and statistics.
/// Unreadable ticks are skipped and reported. Refuses a file without readable ticks.
/// web/src/report/report_data.ts reads the result.
/// @param before_path the previous session, whose figures are shown for comparison; empty: none
/// @param progress called now and then with the fraction read, 0 to 1
[[nodiscard]] Expected<nlohmann::json> reportData(const std::string& recording_path,
                                                  const std::string& before_path,
                                                  const std::function<void(double)>& progress = {});

}  // namespace wholehand
