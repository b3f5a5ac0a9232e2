#pragma once

#include <atomic>
#include <cstdint>
#include <string>

namespace wholehand {

/// Shared by signal handlers and loops. Only atomics, so that a stop by Ctrl-C needs no other
/// thread. Owned by the code that handles signals, for the lifetime of the process.
struct Interrupts {
  std::atomic<int> asked{0};  ///< number of requests to end the process
  std::atomic<int> loops{0};  ///< sessions whose loop still ticks, so their device is not at
                              ///< neutral yet
  /// End of the newest tick of such a loop, or the time of its start, CLOCK_MONOTONIC.
  std::atomic<std::int64_t> ticked_ns{0};
};
static_assert(std::atomic<int>::is_always_lock_free, "written in a signal handler");

/// Handles signals during its lifetime. Ctrl-C, SIGTERM, SIGHUP and Ctrl-Z (which would freeze the
/// loop while the device holds its last effort) request a gentle stop of the current run. SIGUSR1,
/// SIGUSR2, SIGXCPU, SIGPWR and the timers' signals do the same, unless the program handles them
/// itself. SIGPIPE, SIGXFSZ, SIGTTOU and SIGTTIN are ignored, since they would also end or freeze
/// the loop. Signals that were ignored before (nohup) stay ignored.
///
/// A separate thread takes the signals. They are blocked in the calling thread and in those that it
/// starts, so none interrupts the loop or a thread that waits for a disk. Sessions that use
/// shared() stop on their own. The second Ctrl-C (SIGTERM, SIGHUP, SIGQUIT and Ctrl-Z count as one)
/// prints what the program waits for (WaitingFor), or that the loop hangs. The third ends the
/// process whatever hangs, and unwritten data is lost. A loop that still ticks, and then the
/// program's own end, get two seconds first; a loop that hangs gets none, and the device then holds
/// its last effort until its own watchdog or emergency stop ends it.
///
/// A program that runs a loop creates one scope around everything it runs. Scopes may nest in one
/// thread.
class InterruptScope {
 public:
  InterruptScope();
  ~InterruptScope();
  InterruptScope(const InterruptScope&) = delete;
  InterruptScope& operator=(const InterruptScope&) = delete;
  /// True once a signal was received since the outermost scope began. Any thread.
  [[nodiscard]] static bool interrupted() noexcept { return shared().asked.load() > 0; }
  /// Shared state for RunPlan::interrupts and SessionConfig::interrupts.
  [[nodiscard]] static Interrupts& shared() noexcept;
};

/// Sets the text that a second Ctrl-C prints during its lifetime: "waiting for the disk: recording
/// run.h5". The newest object counts. Any thread; not in the tick.
class WaitingFor {
 public:
  explicit WaitingFor(std::string what);
  ~WaitingFor();
  WaitingFor(const WaitingFor&) = delete;
  WaitingFor& operator=(const WaitingFor&) = delete;
};

}  // namespace wholehand
