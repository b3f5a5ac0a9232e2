#pragma once

#include "device/haptic_device.hpp"
#include "device/plugin/device_driver.hpp"
#include "model/device_model.hpp"

#include <array>
#include <cstdint>
#include <memory>

namespace wholehand {

/// Longest time that the samples of a device may stand still: the file's `longest_gap_s`, or 20 ms
/// [s].
[[nodiscard]] double longestStill_s(const DeviceModel& model);

/// A real device behind a driver. Axes are matched by name. The driver may have more axes than the
/// device file, in any order; those get no effort.
class PluginDevice final : public HapticDevice {
 public:
  /// Checks the device file against the driver's description. Refused, all at once: an axis that
  /// the driver lacks, of another kind, with less travel or effort than the file states, with a
  /// coarser encoder or longer delay than the certificate assumes, with another meaning of effort,
  /// and a drive without a watchdog.
  /// @param period_s T, for the delay
  [[nodiscard]] static Expected<std::unique_ptr<HapticDevice>> make(
      const std::shared_ptr<DeviceDriver>& driver, const DeviceModel& model, double period_s);

  /// Enables the device.
  [[nodiscard]] Expected<Done> open() override;
  /// Whether the device is enabled and homed, and no drive is in fault.
  [[nodiscard]] Expected<Done> ready() override;
  /// Sets kDeviceRead where the driver fails or an axis is missing; kDriveFault, kEnableLost and
  /// kDriveHot as the device reports; kStaleSample where samples stand still or go back in time.
  [[nodiscard]] Fault read(DeviceReading& reading, int elapsed_periods) noexcept override;
  [[nodiscard]] Fault write(const AxisEffort& effort) noexcept override;
  /// Disables the device; the driver stays open.
  void close() noexcept override;

 private:
  PluginDevice(std::shared_ptr<DeviceDriver> driver, int axes, int most_still_periods)
      : driver_(std::move(driver)), axes_(axes), most_still_periods_(most_still_periods) {}
  [[nodiscard]] Fault judge(const wh_sample& sample, int elapsed_periods) noexcept;

  std::shared_ptr<DeviceDriver> driver_;
  int axes_;
  int most_still_periods_;
  std::array<int, WH_MAX_AXES> place_{};  ///< axis of the file → axis of the driver
  bool enabled_ = false, begun_ = false;
  int still_periods_ = 0;
  wh_sample last_{};
  wh_command command_{};
};

}  // namespace wholehand
