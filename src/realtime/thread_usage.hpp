#pragma once

#include <cstdint>
#include <sys/resource.h>

namespace wholehand {

/// The kernel's counters of a thread since it started.
struct ThreadUsage {
  std::int64_t minor_faults = 0;          ///< pages that were in memory but not mapped
  std::int64_t major_faults = 0;          ///< pages read from disk
  std::int64_t voluntary_switches = 0;    ///< it waited
  std::int64_t involuntary_switches = 0;  ///< it was preempted
};

/// Counters of the calling thread. Always a system call, below 1 µs. Real-time safe.
[[nodiscard]] inline ThreadUsage threadUsage() noexcept {
  rusage usage{};
  getrusage(RUSAGE_THREAD, &usage);
  return {usage.ru_minflt, usage.ru_majflt, usage.ru_nvcsw, usage.ru_nivcsw};
}

}  // namespace wholehand
