#pragma once

#include "loop/core/expected.hpp"
#include "loop/core/tick_record.hpp"
#include "loop/runtime/statistics.hpp"
#include "record/recording.hpp"

#include <nlohmann/json.hpp>

#include <cstdint>
#include <functional>
#include <string>
#include <vector>

namespace wholehand {

/// Timing, faults and settings of the loop, from every tick of a recording.
class EngineeringFacts {
 public:
  /// @pre meta outlives this object
  explicit EngineeringFacts(const RecordingMeta& meta);

  void add(const TickRecord& record);
  /// The facts as web/src/report/report_data.ts reads them.
  [[nodiscard]] nlohmann::json json() const;

 private:
  [[nodiscard]] nlohmann::json timesJson(const TickSummary& summary) const;

  const RecordingMeta& meta_;
  TickStatistics statistics_;
  std::vector<std::uint64_t> wall_,
      cpu_;  ///< histogram of ticks, bin width 1 % of the period; the last bin counts overflows
  std::uint64_t records_ = 0, damped_ = 0;
};

/// Number of ticks from which a recording is long: datasets that only states need are then read for
/// the shown states alone.
inline constexpr std::uint64_t kLongRecording_ticks = 1'500'000;  // one state in 1000 ticks at that
                                                                  // length

/// Collects the data of a report page in one pass, from a recording of any length or from a black
/// box file: description, scene, a few hundred states, the extremes of all series, and statistics.
/// Unreadable ticks are skipped and reported. Refuses a file without readable ticks.
/// web/src/report/report_data.ts reads the result.
/// @param before_path recording of the previous session, whose figures are shown for comparison;
/// empty: none
/// @param progress called at times with the fraction read, 0 to 1
/// @param long_from number of ticks of a long recording; the result does not depend on it
/// @param not_shown receives the parts of the recording that the page does not show (notShown());
/// may be null
[[nodiscard]] Expected<nlohmann::json> reportData(const std::string& recording_path,
                                                  const std::string& before_path,
                                                  const std::function<void(double)>& progress = {},
                                                  std::uint64_t long_from = kLongRecording_ticks,
                                                  Diagnostics* not_shown = nullptr);

}  // namespace wholehand
