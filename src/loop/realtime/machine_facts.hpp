#pragma once

#include "loop/core/expected.hpp"
#include "loop/realtime/periodic_thread.hpp"

#include <array>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace wholehand {

/// The properties of this machine that determine the loop's jitter.
struct MachineFacts {
  std::string kernel;                    ///< release, e.g. "6.1.0-25-rt-amd64"
  bool real_time_kernel = false;         ///< PREEMPT_RT
  int cpus_allowed = 0;                  ///< cores that this program may use
  int cpus_online = 0;                   ///< cores the machine has
  std::vector<int> isolated;             ///< isolated cores (isolcpus)
  std::string governor;                  ///< e.g. "powersave"; empty when the kernel shows none
  std::int64_t rtprio_limit = 0;         ///< largest real-time priority; -1 is unlimited
  std::int64_t memlock_limit_bytes = 0;  ///< memory that may be locked; -1 is unlimited
};

/// Reads the properties of this machine.
/// @param sys folder in which the kernel shows cores and governors; tests pass another one
[[nodiscard]] MachineFacts machineFacts(const std::string& sys = "/sys");

/// True for a PREEMPT_RT kernel: the content of /sys/kernel/realtime (empty without the file) is 1,
/// or the kernel's version string names PREEMPT_RT, since some real-time kernels lack that file.
[[nodiscard]] bool isRealTimeKernel(std::string_view sys_kernel_realtime,
                                    std::string_view uname_version);

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
  /// Number of wake-ups per bin: lateness below the bin's upper bound and not below the previous
  /// bound.
  std::array<std::uint64_t, kLatenessClass_ns.size() + 1> classes{};
};

/// Sorts the samples and reads the percentiles by nearest rank: the smallest sample that at least p
/// % of all samples do not exceed. All zero without samples.
[[nodiscard]] WakeUpStatistics wakeUpStatistics(std::span<std::int64_t> lateness_ns);

/// Result of probeWakeUps().
struct WakeUpProbe {
  WakeUpStatistics statistics;
  SetupReport setup;
};
/// Runs an empty loop for `wake_ups` periods in a thread set up like the renderer's, as cyclictest
/// does. Returns its lateness and the settings that the machine granted. Takes wake_ups * period;
/// not real-time safe.
/// @param progress receives the number of wake-ups so far, in the calling thread, ten times a
/// second; may be empty
[[nodiscard]] Expected<WakeUpProbe> probeWakeUps(
    const PeriodicThreadConfig& config, std::size_t wake_ups,
    const std::function<void(std::size_t done)>& progress = {});

}  // namespace wholehand
