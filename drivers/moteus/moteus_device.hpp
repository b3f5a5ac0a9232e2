#pragma once

#include "bus_clock.hpp"
#include "can_bus.hpp"
#include "loop/core/expected.hpp"
#include "moteus_round.hpp"
#include "motor_map.hpp"
#include "settings.hpp"
#include "wholehand/device.h"

#include <cstdint>
#include <functional>
#include <memory>
#include <string>

namespace wholehand::moteus {

/// Time for which a command of the loop holds; then the drive's watchdog releases [s].
inline constexpr double kWatchdog_s = 0.02;
/// Time for which the zero torque of WH_ENABLE holds while the loop starts [s].
inline constexpr double kArmingWatchdog_s = 2.0;

/// Axes moved by moteus drives, with the interface of device.h. No thread: write() sends a command
/// and asks for the state, read() takes the answers that have arrived. A sample is therefore as old
/// as the round trip on the bus, at most a period if three drives share a bus of 5 Mbit/s. Its time
/// is that of the question. An answer more than 3 ms late is not used.
class MoteusDevice {
 public:
  using Report = std::function<void(const std::string&)>;

  MoteusDevice(Settings settings, std::unique_ptr<CanBus> bus, std::unique_ptr<BusClock> clock,
               Report report);
  /// Stops the drives.
  ~MoteusDevice();
  MoteusDevice(const MoteusDevice&) = delete;
  MoteusDevice& operator=(const MoteusDevice&) = delete;

  /// Finds every drive and checks its settings (checkDrive()); returns all refusals at once. Waits.
  [[nodiscard]] Expected<Done> check();
  /// Identity of all drives together: a number that differs for another set of drives, and the
  /// firmware, of each drive if they differ. Empty when a drive does not answer. Waits.
  void identify(wh_identity& identity);
  /// Implements wh_plugin.describe, control, read, write.
  void describe(wh_axis* axes, std::uint32_t capacity, std::uint32_t& count) const;
  /// WH_ENABLE: a stop, which clears faults and time-outs, then zero torque. Refused when a drive
  /// is not homed, does not enter position mode, or answers late. WH_DISABLE: zero torque, then a
  /// stop. WH_SELF_TEST: check(). WH_DROP_WATCHDOG: from now on only questions are sent. Waits.
  [[nodiscard]] int control(std::uint32_t verb);
  [[nodiscard]] int read(wh_sample& sample) noexcept;
  [[nodiscard]] int write(const wh_command& command) noexcept;

  [[nodiscard]] const MoteusRound& round() const noexcept { return round_; }

 private:
  [[nodiscard]] int enable();
  [[nodiscard]] int disable();
  [[nodiscard]] bool awaitRound();
  /// Asks all drives, and repeats while some do not answer. False: the adapter accepts nothing.
  [[nodiscard]] bool queryAll();
  [[nodiscard]] bool awaitPositionMode();
  void reportStop();
  [[nodiscard]] std::string nameOf(std::size_t motor) const;
  [[nodiscard]] std::uint32_t status() const noexcept;
  [[nodiscard]] std::int32_t vendorCode() const noexcept;
  [[nodiscard]] bool mayBegin() const noexcept;
  [[nodiscard]] bool sendPending() noexcept;

  Settings settings_;
  MotorMap map_;
  std::unique_ptr<CanBus> bus_;
  std::unique_ptr<BusClock> clock_;
  Report report_;
  MoteusRound round_;
  bool enabled_ = false, feeds_ = true, failed_ = false;
  bool pending_ = false;
  PerMotor torque_nm_{};
  std::uint64_t reported_ = 0;  ///< rounds that read() has returned
};

}  // namespace wholehand::moteus
