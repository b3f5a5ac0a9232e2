#pragma once

#include "devices/plugin/device_driver.hpp"
#include "loop/device/haptic_device.hpp"
#include "loop/model/device_model.hpp"
#include "loop/realtime/monotonic_clock.hpp"

#include <array>
#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <utility>

namespace wholehand {

struct Cleared;

/// Proof that a real device has a passport and was checked today: clearToArm() gives one. Without
/// it a device behind a driver is not armed where it may move a person.
class Clearance {
 public:
  /// For an experiment: nobody is attached to the device, and the recording says so.
  [[nodiscard]] static Clearance withoutPassport() { return Clearance(""); }

  /// Digest of the passport; empty: without one.
  [[nodiscard]] const std::string& passport() const noexcept { return passport_; }

 private:
  friend Cleared;
  explicit Clearance(std::string passport) : passport_(std::move(passport)) {}

  std::string passport_;
};

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
  /// a drive without a watchdog, and an axis that weighs something where the driver enables without
  /// its neutral effort.
  /// @param period_s T, for the delay @param clearance needed where the device may move a person
  /// @param now_ns the clock of the samples; real-time safe
  [[nodiscard]] static Expected<std::unique_ptr<HapticDevice>> make(
      const std::shared_ptr<DeviceDriver>& driver, const DeviceModel& model, double period_s,
      std::optional<Clearance> clearance = std::nullopt,
      std::int64_t (*now_ns)() noexcept = &monotonicNow_ns);

  /// Refused where an axis would fall between two sessions: a host must hold it.
  [[nodiscard]] Expected<Done> open() override;
  /// Whether the device is homed, and no drive is in fault.
  [[nodiscard]] Expected<Done> ready() override;
  [[nodiscard]] Expected<Done> cleared() const override;
  /// Refused, and disabled again, where efforts do not reach the motors.
  [[nodiscard]] Expected<Done> enable() override;
  /// Sets kDeviceRead where the driver fails or an axis is missing; kDriveFault, kEnableLost and
  /// kDriveHot as the device reports; kStaleSample where a sample is older than
  /// longestStill_s() or of the future, samples stand still or go back in time; kSampleDelay where
  /// their mean age over the last tenth of a second is more than the certificate's delay and a
  /// period; kEffortAstray where the mean of an effort that a drive measures is not that of the
  /// efforts sent.
  [[nodiscard]] Fault read(DeviceReading& reading, int elapsed_periods) noexcept override;
  [[nodiscard]] Fault write(const AxisEffort& effort) noexcept override;
  /// Disables the device; the driver stays open.
  void close() noexcept override;

 private:
  PluginDevice(std::shared_ptr<DeviceDriver> driver, const DeviceModel& model, double period_s,
               std::int64_t (*now_ns)() noexcept);
  [[nodiscard]] Fault judgeAge(const wh_sample& sample) noexcept;
  [[nodiscard]] Fault judgeEfforts(const wh_sample& sample) noexcept;
  [[nodiscard]] Expected<Done> mayFall() const;
  [[nodiscard]] Diagnostic no(const std::string& why, const std::string& remedy) const;
  [[nodiscard]] Fault judge(const wh_sample& sample, int elapsed_periods) noexcept;

  std::shared_ptr<DeviceDriver> driver_;
  std::optional<Clearance> clearance_;
  int axes_;
  double period_s_;
  double most_age_s_, most_mean_age_s_;
  int most_still_periods_;
  std::int64_t (*now_ns_)() noexcept;
  std::array<int, WH_MAX_AXES> place_{};  ///< axis of the file → axis of the driver
  wh_command neutral_{};
  bool open_ = false, enabled_ = false, begun_ = false;
  /// A sample came since it was enabled. Some drives give one with every command only.
  bool current_ = false;
  int still_periods_ = 0;
  double mean_age_s_ = 0.0;
  wh_sample last_{};
  wh_command command_{};
  AxisEffort effort_limit_, mean_sent_, mean_measured_;  ///< of the file's axes
};

}  // namespace wholehand
