#pragma once

#include <cfenv>
#include <cstddef>
#include <string>
#include <string_view>
#include <vector>

namespace wholehand {

/// Settings to request for a real-time thread.
struct ThreadSetupConfig {
  int fifo_priority = 80;   ///< SCHED_FIFO priority, range [1, 99]; 0 keeps the scheduling policy
  bool lock_memory = true;  ///< lock the process's pages and keep the heap from shrinking
  /// Pin to the last isolated core, or to the last allowed one if none is isolated.
  bool pin_to_last_core = true;
  /// Number of cores before that one, for a thread that runs beside the loop.
  int cores_before_last = 0;
  std::size_t stack_bytes = std::size_t{512} << 10U;  ///< stack to prefault
};

/// Result of one request.
struct SetupLine {
  std::string what;  ///< "real-time priority"
  bool granted = false;
  std::string sentence;  ///< what was granted, or why not and the remedy; ends with a full stop
};
using SetupReport = std::vector<SetupLine>;

/// Requests everything in `config` for the calling thread (memory: for the whole process). Never
/// fails: the report says what the machine refused. Not for the tick; call once before it.
[[nodiscard]] SetupReport setUpThread(const ThreadSetupConfig& config);

/// From now on flushes denormal operands and results (below 2.2e-308) of this thread to 0. They
/// cost about a hundred cycles each and are far below anything that can be felt. A replay that must
/// match bit by bit needs the same setting. Returns false on an unknown processor. Real-time safe.
bool flushDenormals() noexcept;

/// Applies flushDenormals() during its lifetime, then restores this thread's floating-point mode.
/// For code that ticks on a thread which it does not own. Not for use in the tick.
class DenormalsFlushed {
 public:
  DenormalsFlushed() noexcept {
    std::fegetenv(&before_);
    flushDenormals();
  }
  ~DenormalsFlushed() { std::fesetenv(&before_); }
  DenormalsFlushed(const DenormalsFlushed&) = delete;
  DenormalsFlushed& operator=(const DenormalsFlushed&) = delete;

 private:
  std::fenv_t before_{};
};

/// Requests SCHED_FIFO for the calling thread. @pre 1 <= priority <= 99
[[nodiscard]] SetupLine requestFifoPriority(int priority);
/// Locks memory: MCL_CURRENT always, MCL_FUTURE only when RLIMIT_MEMLOCK is unlimited. Below a
/// limit MCL_FUTURE is granted, and then the next large allocation fails.
[[nodiscard]] SetupLine requestLockedMemory();
/// Index of the last isolated core, or of the last core that this process may use if none is
/// isolated, minus an offset. -1 when there is only one core.
[[nodiscard]] int lastCore(int cores_before_last = 0);
/// Pins the calling thread to lastCore(). The offset is reduced when there are not that many cores.
[[nodiscard]] SetupLine requestLastCore(int cores_before_last = 0);

/// Parses the kernel's list "0-2,5" → {0, 1, 2, 5}; skips parts that are not numbers.
[[nodiscard]] std::vector<int> parseCpuList(std::string_view list);
/// The isolated cores (isolcpus); usually none.
[[nodiscard]] std::vector<int> isolatedCpus();

}  // namespace wholehand
