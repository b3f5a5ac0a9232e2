#pragma once

#include <atomic>

namespace wholehand {

/// Shared by signal handlers and loops. Only atomics, so that a stop by Ctrl-C needs no other
/// thread. Owned by the code that handles signals, for the lifetime of the process.
struct Interrupts {
  std::atomic<int> asked{0};  ///< number of requests to end the process
  std::atomic<int> loops{0};  ///< sessions whose loop still ticks, so their device is not at
                              ///< neutral yet
};
static_assert(std::atomic<int>::is_always_lock_free, "written in a signal handler");

}  // namespace wholehand
