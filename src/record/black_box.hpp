#pragma once

#include "loop/core/expected.hpp"
#include "loop/core/tick_record.hpp"
#include "record/recording.hpp"

#include <cstddef>
#include <cstdint>
#include <limits>
#include <memory>
#include <string>
#include <vector>

namespace wholehand {

struct BlackBoxPlan {
  std::string path;  ///< the black box file; missing parent folders are created at writing
  std::uint64_t most_ticks = std::numeric_limits<std::uint64_t>::max();  ///< longest possible run
  /// The crash handler calls this first. It lets a running loop ramp the device to neutral before
  /// the process ends. Async-signal-safe; may be null.
  void (*stop)(void*) noexcept = nullptr;
  void* stop_whom = nullptr;
  double keep_s = 5.0;                                    ///< duration of complete ticks
  std::size_t input_bytes = std::size_t{64} << 20U;       ///< most memory for inputs since arming
  std::size_t most_tick_bytes = std::size_t{256} << 20U;  ///< memory limit for complete ticks
};

/// Keeps the last seconds of ticks and the inputs of every tick since arming in memory. They are
/// written to the black box file after a stopping fault or an emergency stop, and by the crash
/// handler (kCrashSignals). The inputs allow a bit-exact repetition of the run since its arming.
/// See docs/recording.md.
///
/// Each tick is copied into preallocated memory: no allocation, no lock, and no system call except
/// in a thread's first tick, which installs its signal stack.
class BlackBox : public TickListener {
 public:
  /// Allocates all memory and installs the crash handlers until destruction. Returns an error when
  /// memory is short or when four black boxes are armed already.
  [[nodiscard]] static Expected<std::unique_ptr<BlackBox>> arm(const RecordingMeta& meta,
                                                               const BlackBoxPlan& plan);

  /// Brings memory for the next inputs, so that the tick need not. Called about once a tick by one
  /// thread other than the loop's; late, the tick takes a page fault every 4 KiB.
  virtual void provideMemory() noexcept = 0;
  /// True after a stopping fault or an emergency stop. Call it after the run.
  [[nodiscard]] virtual bool wanted() const noexcept = 0;
  /// Writes the file atomically. Does nothing if a crash handler writes it. Not real-time safe.
  [[nodiscard]] virtual Expected<Done> write() = 0;
  [[nodiscard]] virtual const std::string& path() const noexcept = 0;
  /// Bytes of the recorded inputs, and whether the inputs are complete. Call them after the run.
  [[nodiscard]] virtual std::uint64_t inputBytes() const noexcept = 0;
  [[nodiscard]] virtual bool inputsWhole() const noexcept = 0;
};

}  // namespace wholehand
