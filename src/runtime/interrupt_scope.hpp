#pragma once

#include "runtime/interrupts.hpp"

#include <string>

namespace wholehand {

/// While one lives, Ctrl-C, a polite kill, a terminal that is closed and Ctrl-Z (which would freeze
/// the loop while the device holds its last effort) are remembered, and end the run that is going
/// on gently; so do, where the program does not handle them itself, SIGUSR1, SIGUSR2, SIGXCPU,
/// SIGPWR and the timers' signals. SIGPIPE, SIGXFSZ, SIGTTOU and SIGTTIN are ignored then, for they
/// would end or freeze it just as well. What was ignored already (nohup) stays ignored.
///
/// The signals are taken by a thread of their own and kept from the calling one, and from those
/// that it starts: a thread that waits for a disk is sent none of them, and none interrupts the
/// loop. Sessions that shared() is given to stop by themselves. The second Ctrl-C (SIGTERM, SIGHUP,
/// SIGQUIT, Ctrl-Z count as one) says what the program waits for, by WaitingFor; a third ends the
/// process at once, where no loop ticks any more: the device is at neutral, what was not written
/// is lost.
///
/// A program that runs a loop has one, around all that it runs. Scopes may nest, in one thread.
class InterruptScope {
 public:
  InterruptScope();
  ~InterruptScope();
  InterruptScope(const InterruptScope&) = delete;
  InterruptScope& operator=(const InterruptScope&) = delete;
  /// True once it happened, since the outermost scope began. Any thread.
  [[nodiscard]] static bool interrupted() noexcept { return shared().asked.load() > 0; }
  /// For RunPlan::interrupts and SessionConfig::interrupts.
  [[nodiscard]] static Interrupts& shared() noexcept;
};

/// What a second Ctrl-C says while one lives: "waiting for the disk: recording run.h5". The newest
/// counts. Any thread; not for the tick.
class WaitingFor {
 public:
  explicit WaitingFor(std::string what);
  ~WaitingFor();
  WaitingFor(const WaitingFor&) = delete;
  WaitingFor& operator=(const WaitingFor&) = delete;
};

}  // namespace wholehand
