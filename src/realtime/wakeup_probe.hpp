#pragma once

#include "core/expected.hpp"
#include "realtime/periodic_thread.hpp"

#include <cstdint>
#include <span>

namespace wholehand {

/// How late a loop woke up, over many periods.
struct WakeUpStatistics {
  std::uint64_t wake_ups = 0;
  std::uint64_t skipped_periods = 0;
  std::int64_t p50_ns = 0;
  std::int64_t p99_ns = 0;
  std::int64_t p999_ns = 0;
  std::int64_t max_ns = 0;
};

/// Sorts the samples and reads off the percentiles by nearest rank: the smallest sample that at
/// least p % of all do not exceed. All zero without samples.
[[nodiscard]] WakeUpStatistics wakeUpStatistics(std::span<std::int64_t> lateness_ns);

/// Runs an empty loop for `wake_ups` periods in a thread set up as the renderer's, and tells how
/// late it was woken and what the machine granted. Takes wake_ups * period; not real-time safe.
struct WakeUpProbe {
  WakeUpStatistics statistics;
  SetupReport setup;
};
[[nodiscard]] Expected<WakeUpProbe> probeWakeUps(const PeriodicThreadConfig& config,
                                                 std::size_t wake_ups);

}  // namespace wholehand
