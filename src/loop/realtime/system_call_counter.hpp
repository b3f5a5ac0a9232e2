#pragma once

#include <cstdint>
#include <string>
#include <sys/resource.h>

namespace wholehand {

/// Makes the kernel report the calling thread's system calls to a counter, whichever code makes
/// them. Every call that sleeps, waits, reads, writes or grows memory is seen; clocks that the vDSO
/// serves are not system calls. Call once per thread before counting; takes over the process's
/// SIGSYS. Needs Linux 5.11 on x86-64, and no sanitizer.
/// @return empty; else the reason why counting is not available
[[nodiscard]] std::string watchSystemCalls();

/// Switches the counting of this thread's system calls on or off. A counted call takes some
/// microseconds. No effect in a thread that is not watched. Do not start a thread or a process
/// while counting. Real-time safe.
void countSystemCalls(bool on) noexcept;

/// System calls counted in this thread: all, or those of one number of <sys/syscall.h>. Real-time
/// safe.
[[nodiscard]] std::uint64_t threadSystemCalls() noexcept;
[[nodiscard]] std::uint64_t threadSystemCalls(int number) noexcept;

/// The kernel's counters of a thread since it started.
struct ThreadUsage {
  std::int64_t minor_faults = 0;          ///< pages that were in memory but not mapped
  std::int64_t major_faults = 0;          ///< pages read from disk
  std::int64_t voluntary_switches = 0;    ///< the thread waited
  std::int64_t involuntary_switches = 0;  ///< the thread was preempted
};

/// Counters of the calling thread. Always a system call, below 1 µs. Real-time safe.
[[nodiscard]] inline ThreadUsage threadUsage() noexcept {
  rusage usage{};
  getrusage(RUSAGE_THREAD, &usage);
  return {usage.ru_minflt, usage.ru_majflt, usage.ru_nvcsw, usage.ru_nivcsw};
}

}  // namespace wholehand
