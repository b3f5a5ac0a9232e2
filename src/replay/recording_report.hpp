#pragma once

#include "core/expected.hpp"

#include <nlohmann/json_fwd.hpp>

#include <functional>
#include <string>

namespace wholehand {

/// What the page of a report carries of a recording of any length, or of a black box, which is read
/// once: what it is, its scene, up to some hundred states, the extremes of all series, and figures.
/// Ticks that cannot be read are left out, and told. Refuses a file of which nothing can be read.
/// web/src/report/report_data.ts reads it.
/// @param before_path the session before, whose figures stand beside its own; empty: none
/// @param progress hears now and then how much has been read, 0 to 1
[[nodiscard]] Expected<nlohmann::json> reportData(const std::string& recording_path,
                                                  const std::string& before_path,
                                                  const std::function<void(double)>& progress = {});

}  // namespace wholehand
