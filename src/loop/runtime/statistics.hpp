#pragma once

#include "loop/core/fault.hpp"
#include "loop/core/tick_record.hpp"
#include "loop/model/device_model.hpp"

#include <array>
#include <cstdint>
#include <mutex>
#include <string>
#include <vector>

namespace wholehand {

/// p50, p99, p99.9 and maximum of many durations [ns]; all zero when there are none.
struct Percentiles {
  double p50_ns = 0.0, p99_ns = 0.0, p999_ns = 0.0, max_ns = 0.0;
};

/// Histogram of durations with bins of equal ratio. Percentiles are within 0.5 % of the exact ones
/// for any number of durations, in constant memory. Range 10 ns .. 1000 s; the first and last bin
/// also count what is beyond.
class DurationHistogram {
 public:
  DurationHistogram();

  void add(std::int64_t duration_ns);
  /// Smallest duration that at least `share` (0 .. 1) of all durations do not exceed (nearest
  /// rank), within 0.5 %; never above the maximum. 0 without durations.
  [[nodiscard]] double quantile(double share) const;
  [[nodiscard]] Percentiles percentiles() const;
  [[nodiscard]] std::uint64_t count() const noexcept { return count_; }
  [[nodiscard]] std::int64_t maxNs() const noexcept { return max_ns_; }

 private:
  std::vector<std::uint64_t> bins_;
  std::uint64_t count_ = 0;
  std::int64_t max_ns_ = 0, min_ns_ = INT64_MAX;
};

/// Summary of a run so far.
struct TickSummary {
  std::uint64_t ticks = 0;    ///< periods, including skipped ones: the sum of elapsed_periods
  std::uint64_t records = 0;  ///< ticks that ran
  std::uint64_t missed_deadlines = 0;              ///< skipped periods
  std::array<std::uint64_t, kFaultBits> faults{};  ///< ticks in which each bit was set
  /// Number of ticks with a fault, by fault and axis (fault_axis), of the records seen. A record
  /// names only the first axis of its first fault; other axes of that tick are not counted.
  std::array<std::array<std::uint64_t, kMaxAxes>, kFaultBits> fault_axes{};
  std::uint64_t stopping_faults = 0;  ///< ticks with a fault that stops rendering
  AxisEffort max_effort;              ///< largest |sent| per axis [N or N·m]
  /// Work of the device on the person and on itself: efforts sent times motion, all axes [J]. It
  /// is negative where the person works, and no reason to stop.
  double work_j = 0.0;
  std::int32_t contacts_max = 0;  ///< largest number of contacts in one tick
  double max_coupling_error_rad = 0.0;
  Percentiles cpu, wall, lateness;
  std::array<Percentiles, kStages> stage_cpu{};
  double time_s = 0.0;        ///< time of the last tick
  std::int32_t contacts = 0;  ///< in the last tick
  AxisEffort sent;            ///< in the last tick
  /// Exercise values of the last tick that had any, in the order of the exercise's value names.
  std::int32_t value_count = 0;
  std::array<double, kMaxExerciseValues> values{};
};

/// Running statistics of records, without storing them. Any thread may take a snapshot while
/// another one adds. Uses a lock: not for the tick.
class TickStatistics {
 public:
  void add(const TickRecord& record);
  [[nodiscard]] TickSummary snapshot() const;

 private:
  mutable std::mutex mutex_;
  TickSummary totals_;     ///< all but the percentiles
  AxisPosition q_before_;  ///< of the last record
  DurationHistogram cpu_, wall_, lateness_;
  std::array<DurationHistogram, kStages> stages_;
};

/// Text of the faults that stopped a run: "device read failed in 1 tick"; "none".
/// @param axes names of the device's axes, for faults of an axis
[[nodiscard]] std::string faultText(const TickSummary& summary,
                                    const std::vector<DeviceAxis>& axes = {});
/// Text of the limits and events that did not stop the run: "effort limited in 12 ticks (x 10,
/// finger_flexion 2)"; "none".
[[nodiscard]] std::string noticeText(const TickSummary& summary,
                                     const std::vector<DeviceAxis>& axes = {});

}  // namespace wholehand
