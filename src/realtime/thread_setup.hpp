#pragma once

#include <cfenv>
#include <cstddef>
#include <string>
#include <string_view>
#include <vector>

namespace wholehand {

/// What to ask of the machine for a real-time thread.
struct ThreadSetupConfig {
  int fifo_priority = 80;   ///< SCHED_FIFO priority, range [1, 99]; 0 leaves the scheduling alone.
  bool lock_memory = true;  ///< Lock the process's pages and keep the heap from shrinking.
  bool pin_to_last_core = true;  ///< The last isolated core, else the last one allowed.
  int cores_before_last = 0;     ///< For a thread beside such a one: so many cores before that.
  std::size_t stack_bytes = std::size_t{512} << 10U;  ///< Stack to touch beforehand.
};

/// What became of one request.
struct SetupLine {
  std::string what;  ///< "real-time priority"
  bool granted = false;
  std::string sentence;  ///< what was granted, or why not and the remedy; ends with a full stop
};
using SetupReport = std::vector<SetupLine>;

/// Asks for everything in `config` for the calling thread (memory: for the whole process). Never
/// fails: what the machine refuses is told in the report. Not for the tick; call it once before.
[[nodiscard]] SetupReport setUpThread(const ThreadSetupConfig& config);

/// From now on this thread's results and operands below 2.2e-308 count as 0: they cost about a
/// hundred cycles each and are far below anything felt. A replay that must match bit by bit needs
/// it in its thread as well. False where the processor is not known. Real-time safe.
bool flushDenormals() noexcept;

/// flushDenormals() while it lives, then this thread's rounding and denormals as they were: for
/// ticks on a thread that belongs to somebody else. Not for the tick.
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

/// SCHED_FIFO for the calling thread. @pre 1 <= priority <= 99
[[nodiscard]] SetupLine requestFifoPriority(int priority);
/// MCL_CURRENT always; MCL_FUTURE only where RLIMIT_MEMLOCK is unlimited, since below a limit it
/// is granted and then the next large allocation fails.
[[nodiscard]] SetupLine requestLockedMemory();
/// The last isolated core, else the last one that this process may use, or one so many before it.
/// -1 where there is but one.
[[nodiscard]] int lastCore(int cores_before_last = 0);
/// Pins the calling thread to the last isolated core, else to the last core it may use; or to one
/// of those before it, where there are as many.
[[nodiscard]] SetupLine requestLastCore(int cores_before_last = 0);

/// "0-2,5" as the kernel writes it → {0, 1, 2, 5}; parts that are no numbers are left out.
[[nodiscard]] std::vector<int> parseCpuList(std::string_view list);
/// The cores the kernel keeps free of other work (isolcpus); usually none.
[[nodiscard]] std::vector<int> isolatedCpus();

}  // namespace wholehand
