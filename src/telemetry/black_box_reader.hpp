#pragma once

#include "telemetry/input_log.hpp"
#include "telemetry/recording.hpp"

#include <cstdint>
#include <memory>
#include <string>

namespace wholehand {

/// Why and when a black box was written.
struct BlackBoxCause {
  int signal = 0;                ///< that ended the process; 0: none
  Fault faults = Fault::kNone;   ///< that stopped the run, with kEmergencyStop
  std::uint64_t fault_tick = 0;  ///< of the first of them, and on which axis
  int fault_axis = -1;
  std::int64_t unix_ns = 0;
  bool within_tick = false;  ///< a tick had begun that had not ended
};

/// A black box as it was written: the recording of its last seconds, and what every tick since
/// arming took from outside.
class BlackBoxReader : public RecordingReader {
 public:
  /// Refuses a file that is foreign, damaged, cut off, or of a program that lays its ticks out
  /// differently.
  [[nodiscard]] static Expected<std::unique_ptr<BlackBoxReader>> openBox(const std::string& path);
  /// True for a file that begins as a black box does, whatever follows.
  [[nodiscard]] static bool isBox(const std::string& path);

  [[nodiscard]] virtual const BlackBoxCause& cause() const = 0;
  /// False where the run was longer than the memory for inputs: the box shows, and cannot be run
  /// again.
  [[nodiscard]] virtual bool inputsWhole() const = 0;
  /// What the next tick took, from the first one on. False at the end.
  [[nodiscard]] virtual bool nextInput(TickInput& input) = 0;
  /// Ticks since arming whose inputs are kept.
  [[nodiscard]] virtual std::uint64_t inputTicks() const = 0;
};

}  // namespace wholehand
