#pragma once

#include <cstdint>

namespace wholehand {

/// Calls with which a thread may wait for another, or wake one up: each is a kernel call as soon as
/// two threads meet there.
struct LockCalls {
  std::uint64_t locks = 0;  ///< mutexes, spin locks, read-write locks; also tries
  std::uint64_t waits = 0;  ///< condition variables and semaphores
  std::uint64_t wakes = 0;  ///< condition variables and semaphores
};

/// False where a sanitizer owns these calls: every count is then 0 and proves nothing.
[[nodiscard]] bool lockCountingAvailable() noexcept;

/// What this thread has called since it began, whoever called it (std::mutex, the physics engine, a
/// library). Not the C library's own: what it takes inside malloc() or printf() never shows itself;
/// malloc is counted by allocation_counter.hpp, and whatever waits in the kernel by
/// system_call_counter.hpp. Real-time safe.
[[nodiscard]] LockCalls threadLockCalls() noexcept;

}  // namespace wholehand
