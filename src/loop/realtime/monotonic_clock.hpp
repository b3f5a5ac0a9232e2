#pragma once

#include <cstdint>
#include <ctime>

namespace wholehand {

/// Monotonic time since an arbitrary start [ns]. Real-time safe: about 20 ns when the vDSO serves
/// it.
[[nodiscard]] inline std::int64_t monotonicNow_ns() noexcept {
  timespec t{};
  clock_gettime(CLOCK_MONOTONIC, &t);
  return std::int64_t{t.tv_sec} * 1'000'000'000 + t.tv_nsec;
}

/// Like monotonicNow_ns(), but the clock also runs while the machine is suspended. Real-time safe.
[[nodiscard]] inline std::int64_t bootNow_ns() noexcept {
  timespec t{};
  clock_gettime(CLOCK_BOOTTIME, &t);
  return std::int64_t{t.tv_sec} * 1'000'000'000 + t.tv_nsec;
}

/// CPU time used by the calling thread [ns]. Real-time safe; always a system call, about 360 ns.
[[nodiscard]] inline std::int64_t threadCpuNow_ns() noexcept {
  timespec t{};
  clock_gettime(CLOCK_THREAD_CPUTIME_ID, &t);
  return std::int64_t{t.tv_sec} * 1'000'000'000 + t.tv_nsec;
}

}  // namespace wholehand
