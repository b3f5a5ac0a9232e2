#pragma once

#include "core/expected.hpp"
#include "core/tick_listener.hpp"
#include "telemetry/recording.hpp"

#include <cstddef>
#include <cstdint>
#include <limits>
#include <memory>
#include <string>
#include <vector>

namespace wholehand {

struct BlackBoxPlan {
  std::string path;                  ///< of the file; its last folders are made when it is written
  std::vector<double> encoder_step;  ///< per axis [m or rad]; 0: it has none
  std::uint64_t most_ticks = std::numeric_limits<std::uint64_t>::max();  ///< a run has
  /// Called first of all when the process crashes: lets the loop, if it still runs, ramp the device
  /// to neutral; the end of the process waits for that. Async-signal-safe; may be null.
  void (*stop)(void*) noexcept = nullptr;
  void* stop_whom = nullptr;
  double keep_s = 5.0;                                    ///< of whole ticks
  std::size_t input_bytes = std::size_t{64} << 20U;       ///< for the inputs since arming
  std::size_t most_tick_bytes = std::size_t{256} << 20U;  ///< for the whole ticks
};

/// The last seconds of ticks, and what every tick since arming took from outside, always in memory:
/// written to a file on a stopping fault or an emergency stop, and by the process itself when it
/// crashes (SIGSEGV, SIGABRT, SIGBUS, SIGFPE, SIGILL). With the inputs the run can be repeated from
/// its arming on, bit by bit. docs/recording.md tells people of it.
///
/// Told of every tick it copies into memory that is there already: no allocation, no lock, and no
/// system call but in the first tick of a thread (which gives it a stack for its signals).
class BlackBox : public TickListener {
 public:
  /// Takes all the memory it will need and stands by for crashes until it is destroyed. Refused
  /// where there is no memory, or four of them are armed already.
  [[nodiscard]] static Expected<std::unique_ptr<BlackBox>> arm(const RecordingMeta& meta,
                                                               const BlackBoxPlan& plan);

  /// A stopping fault or an emergency stop came. After the run.
  [[nodiscard]] virtual bool wanted() const noexcept = 0;
  /// Writes the file, whole or not at all; nothing to do where a crash's handler does. Not
  /// real-time safe.
  [[nodiscard]] virtual Expected<Done> write() = 0;
  [[nodiscard]] virtual const std::string& path() const noexcept = 0;
  /// What the inputs take so far, and whether none is missing. After the run.
  [[nodiscard]] virtual std::uint64_t inputBytes() const noexcept = 0;
  [[nodiscard]] virtual bool inputsWhole() const noexcept = 0;
};

}  // namespace wholehand
