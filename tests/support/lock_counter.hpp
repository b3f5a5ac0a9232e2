#pragma once

#include <cstdint>

namespace wholehand {

/// Calls that may block a thread or wake another one. Each becomes a system call when two threads
/// contend.
struct LockCalls {
  std::uint64_t locks = 0;  ///< mutexes, spin locks, read-write locks; try-locks included
  std::uint64_t waits = 0;  ///< condition variables and semaphores
  std::uint64_t wakes = 0;  ///< condition variables and semaphores
};

/// False when a sanitizer owns these calls. Every count is then 0 and proves nothing.
[[nodiscard]] bool lockCountingAvailable() noexcept;

/// Calls by this thread since it started, including those of std::mutex, the physics engine and
/// libraries. Locks inside the C library (malloc(), printf()) are not visible here:
/// allocation_counter.hpp counts malloc, and system_call_counter.hpp counts everything that waits
/// in the kernel. Real-time safe.
[[nodiscard]] LockCalls threadLockCalls() noexcept;

}  // namespace wholehand
