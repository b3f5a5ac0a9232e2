#pragma once

#include "bus_clock.hpp"
#include "can_bus.hpp"
#include "motor_map.hpp"

#include <array>
#include <cstdint>
#include <vector>

namespace wholehand::moteus {

/// Last state reported by a drive.
struct DriveState {
  int mode = 0, fault = 0, home = 0;
  double position_rad = 0.0;  ///< NaN: unknown to the drive
  double torque_nm = 0.0;
  double temperature_c = 0.0;
  bool answered = false;  ///< at least once
};

/// Rounds on the bus: each sends a frame to every drive, and each drive answers with its state. The
/// next round begins when the last is complete, so that the bus is never overloaded. An answer
/// counts only for the round that asked for it; it is dropped if that round was given up. Real-time
/// safe except for the constructor.
class MoteusRound {
 public:
  MoteusRound(const std::vector<Motor>& motors, CanBus& bus, BusClock& clock);

  /// Begins a round with torques; missing answers of the last round are given up. False when the
  /// bus failed. The drives run in position mode without gains: position NaN, all gains and the
  /// limit of the integral 0, so that only the torque acts. The largest torque is that of the
  /// motor.
  /// @param watchdog_s time for which the command holds
  [[nodiscard]] bool sendTorques(const PerMotor& torque_nm, double watchdog_s) noexcept;
  /// Stops the drives: no torque, and faults and time-outs are cleared.
  [[nodiscard]] bool sendStops() noexcept;
  /// Asks for the states without a command; no watchdog is fed.
  [[nodiscard]] bool sendQueries() noexcept;

  /// Takes the frames that have arrived. False when the bus failed.
  [[nodiscard]] bool receive() noexcept;

  /// True when every drive has answered.
  [[nodiscard]] bool complete() const noexcept { return awaited_ == 0; }
  [[nodiscard]] std::int64_t begun_ns() const noexcept { return begun_ns_; }
  /// Number of completed rounds, begin of the last one, and its states by motor. The drives
  /// measured after that begin, so a sample is never older than its time says.
  [[nodiscard]] std::uint64_t completed() const noexcept { return completed_; }
  [[nodiscard]] std::int64_t completedBegun_ns() const noexcept { return completed_begun_ns_; }
  [[nodiscard]] const DriveState& completedState(std::size_t motor) const noexcept {
    return of_round_[motor];
  }
  /// Newest state of a motor, from the round under way or an earlier one.
  [[nodiscard]] const DriveState& state(std::size_t motor) const noexcept { return last_[motor]; }
  /// Frames that came from no drive in use, and answers that were malformed or incomplete.
  [[nodiscard]] std::uint64_t foreign() const noexcept { return foreign_; }
  [[nodiscard]] std::uint64_t malformed() const noexcept { return malformed_; }

 private:
  void begin() noexcept;
  /// Sends to each motor what `write(writer, motor)` writes, with the question for its state.
  template <class Write>
  [[nodiscard]] bool sendToAll(Write write) noexcept;
  [[nodiscard]] bool send(CanFrame& frame, std::size_t motor) noexcept;
  void take(const CanFrame& frame) noexcept;

  std::vector<Motor> motors_;
  CanBus& bus_;
  BusClock& clock_;
  std::uint32_t awaited_ = 0;  ///< bit i: the answer of motor i is awaited
  unsigned mark_ = 0;          ///< mark of the round's answers
  std::int64_t begun_ns_ = 0, completed_begun_ns_ = 0;
  std::uint64_t completed_ = 0, foreign_ = 0, malformed_ = 0;
  std::array<DriveState, kMostMotors> last_{}, of_round_{};
};

}  // namespace wholehand::moteus
