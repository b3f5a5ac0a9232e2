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

/// For how long a command of the loop holds: then the drive's watchdog lets go [s].
inline constexpr double kWatchdog_s = 0.02;
/// For how long the zero torque of WH_ENABLE holds: the loop is starting meanwhile [s].
inline constexpr double kArmingWatchdog_s = 2.0;

/// Axes that moteus drives move, as device.h wants a driver. No thread: write() sends a command and
/// asks for the state, read() takes the answers that have come. A sample is therefore as old as the
/// round trip on the bus, at most a period where three drives share a bus of 5 Mbit/s. Its time is
/// that of the question. An answer that comes more than 3 ms late is no sample.
class MoteusDevice {
 public:
  using Say = std::function<void(const std::string&)>;

  MoteusDevice(Settings settings, std::unique_ptr<CanBus> bus, std::unique_ptr<BusClock> clock,
               Say say);
  /// Stops the drives.
  ~MoteusDevice();
  MoteusDevice(const MoteusDevice&) = delete;
  MoteusDevice& operator=(const MoteusDevice&) = delete;

  /// Finds every drive and judges its settings (judgeDrive()); all refusals at once. Waits.
  [[nodiscard]] Expected<Done> check();
  /// Of all drives together: a number of so many bits that another set of drives has another, and
  /// the firmware, of each where they differ. Left empty where one does not answer. Waits.
  void identify(wh_identity& identity);
  /// wh_plugin.describe, control, read, write.
  void describe(wh_axis* axes, std::uint32_t capacity, std::uint32_t& count) const;
  /// WH_ENABLE: a stop, which forgets faults and time-outs, then zero torque. Refused where a drive
  /// is not homed, does not come into position mode or answers late. WH_DISABLE: zero torque, then
  /// a stop. WH_SELF_TEST: check(). WH_DROP_WATCHDOG: nothing is sent any more but questions.
  /// Waits.
  [[nodiscard]] int control(std::uint32_t verb);
  [[nodiscard]] int read(wh_sample& sample) noexcept;
  [[nodiscard]] int write(const wh_command& command) noexcept;

  [[nodiscard]] const MoteusRound& round() const noexcept { return round_; }

 private:
  [[nodiscard]] int enable();
  [[nodiscard]] int disable();
  [[nodiscard]] bool awaitRound();
  /// Asks all drives, and those that do not answer again. False: the adapter takes nothing.
  [[nodiscard]] bool queryAll();
  [[nodiscard]] bool awaitPositionMode();
  void sayWhyItStopped();
  [[nodiscard]] std::string nameOf(std::size_t motor) const;
  [[nodiscard]] std::uint32_t status() const noexcept;
  [[nodiscard]] std::int32_t vendorCode() const noexcept;
  [[nodiscard]] bool mayBegin() const noexcept;
  [[nodiscard]] bool sendPending() noexcept;

  Settings settings_;
  MotorMap map_;
  std::unique_ptr<CanBus> bus_;
  std::unique_ptr<BusClock> clock_;
  Say say_;
  MoteusRound round_;
  bool enabled_ = false, feeds_ = true, failed_ = false;
  bool pending_ = false;
  PerMotor torque_nm_{};
  std::uint64_t reported_ = 0;  ///< rounds that read() has handed over
};

}  // namespace wholehand::moteus
