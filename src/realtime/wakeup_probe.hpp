#pragma once

#include "core/expected.hpp"
#include "realtime/periodic_thread.hpp"

#include <array>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <span>

namespace wholehand {

/// Upper ends of the classes of a histogram of lateness; the last class has none.
inline constexpr std::array<std::int64_t, 9> kLatenessClass_ns{
    5'000, 10'000, 20'000, 50'000, 100'000, 200'000, 500'000, 1'000'000, 2'000'000};

/// How late a loop woke up, over many periods.
struct WakeUpStatistics {
  std::uint64_t wake_ups = 0;
  std::uint64_t skipped_periods = 0;
  std::int64_t p50_ns = 0;
  std::int64_t p99_ns = 0;
  std::int64_t p999_ns = 0;
  std::int64_t max_ns = 0;
  /// Wake-ups a class: below its upper end, and not below the one before.
  std::array<std::uint64_t, kLatenessClass_ns.size() + 1> classes{};
};

/// Sorts the samples and reads off the percentiles by nearest rank: the smallest sample that at
/// least p % of all do not exceed. All zero without samples.
[[nodiscard]] WakeUpStatistics wakeUpStatistics(std::span<std::int64_t> lateness_ns);

/// What cyclictest does: runs an empty loop for `wake_ups` periods in a thread set up as the
/// renderer's, and tells how late it was woken and what the machine granted. Takes wake_ups *
/// period; not real-time safe.
struct WakeUpProbe {
  WakeUpStatistics statistics;
  SetupReport setup;
};
/// @param progress told in the calling thread, ten times a second, how many there were; may be
/// empty
[[nodiscard]] Expected<WakeUpProbe> probeWakeUps(
    const PeriodicThreadConfig& config, std::size_t wake_ups,
    const std::function<void(std::size_t done)>& progress = {});

}  // namespace wholehand
