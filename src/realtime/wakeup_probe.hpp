#pragma once

#include "core/expected.hpp"
#include "realtime/periodic_thread.hpp"

#include <array>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <span>

namespace wholehand {

/// Upper bounds of the lateness histogram's bins; the last bin is unbounded.
inline constexpr std::array<std::int64_t, 9> kLatenessClass_ns{
    5'000, 10'000, 20'000, 50'000, 100'000, 200'000, 500'000, 1'000'000, 2'000'000};

/// Wake-up lateness of a loop over many periods.
struct WakeUpStatistics {
  std::uint64_t wake_ups = 0;
  std::uint64_t skipped_periods = 0;
  std::int64_t p50_ns = 0;
  std::int64_t p99_ns = 0;
  std::int64_t p999_ns = 0;
  std::int64_t max_ns = 0;
  /// Wake-ups per bin: below its upper bound, not below the previous one.
  std::array<std::uint64_t, kLatenessClass_ns.size() + 1> classes{};
};

/// Sorts the samples and reads the percentiles by nearest rank: the smallest sample that at least p
/// % of all samples do not exceed. All zero without samples.
[[nodiscard]] WakeUpStatistics wakeUpStatistics(std::span<std::int64_t> lateness_ns);

/// Result of an empty loop that runs for `wake_ups` periods in a thread set up as the renderer's,
/// like cyclictest: its lateness, and what the machine granted. Takes wake_ups * period; not
/// real-time safe.
struct WakeUpProbe {
  WakeUpStatistics statistics;
  SetupReport setup;
};
/// @param progress gets the number of wake-ups so far, in the calling thread, ten times a second;
/// may be empty
[[nodiscard]] Expected<WakeUpProbe> probeWakeUps(
    const PeriodicThreadConfig& config, std::size_t wake_ups,
    const std::function<void(std::size_t done)>& progress = {});

}  // namespace wholehand
