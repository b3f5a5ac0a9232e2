#pragma once

#include <cstdint>
#include <ctime>

namespace wholehand {

/// Time since an arbitrary start, never set back [ns]. Real-time safe: about 20 ns where the
/// kernel serves it without a system call.
[[nodiscard]] inline std::int64_t monotonicNow_ns() noexcept {
  timespec t{};
  clock_gettime(CLOCK_MONOTONIC, &t);
  return std::int64_t{t.tv_sec} * 1'000'000'000 + t.tv_nsec;
}

/// CPU time the calling thread has used [ns]. Real-time safe; always a system call, about 360 ns.
[[nodiscard]] inline std::int64_t threadCpuNow_ns() noexcept {
  timespec t{};
  clock_gettime(CLOCK_THREAD_CPUTIME_ID, &t);
  return std::int64_t{t.tv_sec} * 1'000'000'000 + t.tv_nsec;
}

}  // namespace wholehand
