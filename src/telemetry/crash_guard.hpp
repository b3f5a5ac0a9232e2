#pragma once

#include <cstddef>

namespace wholehand {

/// Told when the process crashes, in the signal's handler: only what is async-signal-safe.
class CrashWitness {
 public:
  virtual ~CrashWitness() = default;
  virtual void crashed(int signal) noexcept = 0;
};

/// The system's number of the thread that asks; never 0. Async-signal-safe.
[[nodiscard]] int callingThread() noexcept;

/// How many witnesses there may be at once.
inline constexpr int kMostWitnesses = 4;

/// Stands by for SIGSEGV, SIGABRT, SIGBUS, SIGFPE and SIGILL until it is destroyed: tells the
/// witness, then lets the signal do what it did before (end the process and dump its core). A crash
/// in another thread meanwhile waits for that, and so does the end of a guard, so that neither the
/// witness nor the process is gone before; a crash in the witness ends the process.
class CrashGuard {
 public:
  explicit CrashGuard(CrashWitness& witness);
  ~CrashGuard();
  CrashGuard(const CrashGuard&) = delete;
  CrashGuard& operator=(const CrashGuard&) = delete;
  /// False where there are kMostWitnesses already.
  [[nodiscard]] bool stands() const noexcept { return slot_ >= 0; }

 private:
  int slot_ = -1;
};

/// What a signal handler may need of stack; an overflow of the thread's own is a crash, too.
inline constexpr std::size_t kSignalStackBytes = std::size_t{64} << 10U;

/// Gives the calling thread this memory as a stack for its signals where it has none.
/// Async-signal-safe; one system call or two.
void useSignalStack(void* memory) noexcept;
/// Takes it away from the calling thread again, where it is in use there.
void leaveSignalStack(void* memory) noexcept;

}  // namespace wholehand
