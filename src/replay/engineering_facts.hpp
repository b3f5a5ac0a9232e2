#pragma once

#include "core/tick_record.hpp"
#include "telemetry/recording.hpp"
#include "telemetry/statistics.hpp"

#include <nlohmann/json.hpp>

#include <cstdint>
#include <vector>

namespace wholehand {

/// Timing, faults and settings of the loop, from every tick of a recording.
class EngineeringFacts {
 public:
  /// @pre meta outlives it
  explicit EngineeringFacts(const RecordingMeta& meta);

  void add(const TickRecord& record);
  /// The facts as web/src/report/report_data.ts reads them.
  [[nodiscard]] nlohmann::json json() const;

 private:
  [[nodiscard]] nlohmann::json timesJson(const TickSummary& summary) const;

  const RecordingMeta& meta_;
  TickStatistics statistics_;
  std::vector<std::uint64_t> wall_,
      cpu_;  ///< histogram of ticks in steps of 1 % of the period; the last bin: beyond
  std::uint64_t records_ = 0, damped_ = 0;
};

}  // namespace wholehand
