#pragma once

#include "bus_clock.hpp"
#include "can_bus.hpp"
#include "motor_map.hpp"

#include <array>
#include <cstdint>
#include <vector>

namespace wholehand::moteus {

/// What a drive said last.
struct DriveState {
  int mode = 0, fault = 0, home = 0;
  double position_rad = 0.0;  ///< NaN: the drive does not know
  double torque_nm = 0.0;
  double temperature_c = 0.0;
  bool answered = false;  ///< at least once
};

/// Rounds on the bus: a frame to every drive, each of which answers with its state. The next round
/// begins when the last is complete, so that the bus is never asked for more than it carries.
/// An answer counts for the round that asked for it, and for no other: one that comes after its
/// round was given up is dropped.
/// Real-time safe but for the constructor.
class MoteusRound {
 public:
  MoteusRound(const std::vector<Motor>& motors, CanBus& bus, BusClock& clock);

  /// Begins a round; what is missing of the last one is given up. False where the bus failed.
  /// Torques: position mode without gains. NaN as position, all gains and the limit of the integral
  /// 0, so that nothing but the torque acts; the largest torque is that of the motor.
  /// @param watchdog_s for how long the command holds
  [[nodiscard]] bool sendTorques(const PerMotor& torque_nm, double watchdog_s) noexcept;
  /// Stops the drives: no torque, and faults and time-outs are forgotten.
  [[nodiscard]] bool sendStops() noexcept;
  /// Asks for the states and commands nothing: no watchdog is fed.
  [[nodiscard]] bool sendQueries() noexcept;

  /// Takes what has come. False where the bus failed.
  [[nodiscard]] bool receive() noexcept;

  /// Every drive has answered.
  [[nodiscard]] bool complete() const noexcept { return awaited_ == 0; }
  [[nodiscard]] std::int64_t begun_ns() const noexcept { return begun_ns_; }
  /// Rounds that were completed, and when the last of them was begun; its states by motor.
  /// The drives measured after that time: a sample is never younger than it says.
  [[nodiscard]] std::uint64_t completed() const noexcept { return completed_; }
  [[nodiscard]] std::int64_t completedBegun_ns() const noexcept { return completed_begun_ns_; }
  [[nodiscard]] const DriveState& completedState(std::size_t motor) const noexcept {
    return of_round_[motor];
  }
  /// The last that was heard, of the round that is under way or an earlier one.
  [[nodiscard]] const DriveState& state(std::size_t motor) const noexcept { return last_[motor]; }
  /// Frames so far that no drive of ours sent, and answers that were malformed or incomplete.
  [[nodiscard]] std::uint64_t foreign() const noexcept { return foreign_; }
  [[nodiscard]] std::uint64_t malformed() const noexcept { return malformed_; }

 private:
  void begin() noexcept;
  /// To each motor what `write(writer, motor)` writes, and the question for its state.
  template <class Write>
  [[nodiscard]] bool sendToAll(Write write) noexcept;
  [[nodiscard]] bool send(CanFrame& frame, std::size_t motor) noexcept;
  void take(const CanFrame& frame) noexcept;

  std::vector<Motor> motors_;
  CanBus& bus_;
  BusClock& clock_;
  std::uint32_t awaited_ = 0;  ///< bit i: the answer of motor i
  unsigned mark_ = 0;          ///< of the round's answers
  std::int64_t begun_ns_ = 0, completed_begun_ns_ = 0;
  std::uint64_t completed_ = 0, foreign_ = 0, malformed_ = 0;
  std::array<DriveState, kMostMotors> last_{}, of_round_{};
};

}  // namespace wholehand::moteus
