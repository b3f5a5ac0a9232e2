#pragma once

#include "record/input_log.hpp"
#include "record/recording.hpp"

#include <cstdint>
#include <memory>
#include <string>

namespace wholehand {

/// Cause and time of the writing of a black box file.
struct BlackBoxCause {
  int signal = 0;                ///< signal that ended the process; 0: none
  Fault faults = Fault::kNone;   ///< faults that stopped the run, with kEmergencyStop
  std::uint64_t fault_tick = 0;  ///< tick of the first of these faults
  int fault_axis = -1;
  std::int64_t unix_ns = 0;
  bool within_tick = false;  ///< the process ended within a tick
};

/// Reads a black box file: the recording of the last seconds, and the inputs of every tick since
/// arming.
class BlackBoxReader : public RecordingReader {
 public:
  /// Refuses a file that is not a black box file, is damaged or truncated, or was written by a
  /// program with another tick layout.
  [[nodiscard]] static Expected<std::unique_ptr<BlackBoxReader>> openBox(const std::string& path);
  /// True for a file that begins with the signature of a black box file; the rest is not checked.
  [[nodiscard]] static bool isBox(const std::string& path);

  [[nodiscard]] virtual const BlackBoxCause& cause() const = 0;
  /// False when the run exceeded the memory for inputs: the file can be shown, but the run cannot
  /// be repeated.
  [[nodiscard]] virtual bool inputsWhole() const = 0;
  /// Reads the inputs of the next tick, beginning with the first. Returns false at the end.
  [[nodiscard]] virtual bool nextInput(TickInput& input) = 0;
  /// Number of ticks since arming with recorded inputs.
  [[nodiscard]] virtual std::uint64_t inputTicks() const = 0;
};

}  // namespace wholehand
