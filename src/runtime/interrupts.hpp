#pragma once

#include <atomic>

namespace wholehand {

/// Between the handlers of signals and the loops: atomics alone, so that a stop by Ctrl-C needs no
/// other thread. Whoever handles signals owns it, for as long as the process lives.
struct Interrupts {
  std::atomic<int> asked{0};  ///< how often the process was asked to end
  std::atomic<int> loops{0};  ///< sessions whose loop still ticks: the device is not at neutral yet
};
static_assert(std::atomic<int>::is_always_lock_free, "written in a signal handler");

}  // namespace wholehand
