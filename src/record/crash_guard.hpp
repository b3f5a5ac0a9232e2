#pragma once

#include <array>
#include <csignal>
#include <cstddef>

namespace wholehand {

/// Signals that end a process that does not handle them, whether caused by its own fault or sent.
inline constexpr std::array kCrashSignals{SIGSEGV, SIGABRT, SIGBUS, SIGFPE,
                                          SIGILL,  SIGTRAP, SIGSYS};

/// Called in the signal handler when the process crashes; must be async-signal-safe.
class CrashHandler {
 public:
  virtual ~CrashHandler() = default;
  virtual void crashed(int signal) noexcept = 0;
};

/// The calling thread's system id; never 0. Async-signal-safe.
[[nodiscard]] int callingThread() noexcept;

/// Maximum number of simultaneous witnesses (registered crash handlers).
inline constexpr int kMostWitnesses = 4;

/// Handles kCrashSignals during its lifetime: calls the witness, then the previous action follows
/// (end the process, dump core). If another thread crashes meanwhile or destroys a guard, it waits
/// for the handler, so that the witness and the process outlive the handler. A crash in the witness
/// ends the process.
class CrashGuard {
 public:
  explicit CrashGuard(CrashHandler& witness);
  ~CrashGuard();
  CrashGuard(const CrashGuard&) = delete;
  CrashGuard& operator=(const CrashGuard&) = delete;
  /// False when kMostWitnesses are registered already.
  [[nodiscard]] bool stands() const noexcept { return slot_ >= 0; }

 private:
  int slot_ = -1;
};

/// Stack size of a signal handler. A separate stack allows it to handle an overflow of the thread's
/// own stack.
inline constexpr std::size_t kSignalStackBytes = std::size_t{64} << 10U;

/// Installs this memory as the calling thread's signal stack if it has none. Async-signal-safe; one
/// or two system calls.
void useSignalStack(void* memory) noexcept;
/// Uninstalls it in the calling thread if it is in use there.
void leaveSignalStack(void* memory) noexcept;

}  // namespace wholehand
