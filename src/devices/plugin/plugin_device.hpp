#pragma once

#include "devices/plugin/device_driver.hpp"
#include "devices/plugin/effort_judge.hpp"
#include "devices/plugin/response_judge.hpp"
#include "loop/device/arming_delay.hpp"
#include "loop/device/haptic_device.hpp"
#include "loop/model/device_model.hpp"
#include "loop/realtime/monotonic_clock.hpp"

#include <array>
#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

namespace wholehand {

struct CheckedPermit;

/// Proof that a real device has a passport and was checked today, from checkArmingPermit(). Without
/// it a device that may move a person is not armed.
class ArmingPermit {
 public:
  /// Clearance for an experiment: nobody is attached to the device, and the recording says so.
  [[nodiscard]] static ArmingPermit withoutPassport() { return ArmingPermit(""); }

  /// Digest of the passport; empty: no passport.
  [[nodiscard]] const std::string& passport() const noexcept { return passport_; }
  /// Figures of the passport, in the order of the device file; empty: no passport.
  [[nodiscard]] const std::vector<MeasuredAxis>& measured() const noexcept { return measured_; }

  /// The delay measured for this arming (delayAtArming()); not measured unless set.
  void setDelay(ArmingDelay delay) { delay_ = std::move(delay); }
  [[nodiscard]] const ArmingDelay& delay() const noexcept { return delay_; }

 private:
  friend CheckedPermit;
  explicit ArmingPermit(std::string passport, std::vector<MeasuredAxis> measured = {})
      : passport_(std::move(passport)), measured_(std::move(measured)) {}

  std::string passport_;
  ArmingDelay delay_;
  std::vector<MeasuredAxis> measured_;
};

/// Longest time for which the samples of a device may stand still [s]: the file's `longest_gap_s`,
/// or 20 ms.
[[nodiscard]] double longestStill_s(const DeviceModel& model);

/// A real device behind a driver. Axes are matched by name. The driver may have more axes than the
/// device file, in any order; those get no effort.
class PluginDevice final : public HapticDevice, public DelayedDevice {
 public:
  /// Checks the device file against the driver's description. Refused, all at once: an axis that
  /// the driver lacks, or that has another kind, less travel or effort than the file states, a
  /// coarser encoder or a longer delay than the certificate assumes, or another meaning of effort;
  /// a drive without a watchdog; and an axis with weight if the driver enables without its neutral
  /// effort.
  /// @param period_s T, for the delay @param permit needed where the device may move a person; a
  ///   longer delay that it names counts for the ages of samples and efforts
  /// @param now_ns the clock of the samples; real-time safe
  [[nodiscard]] static Expected<std::unique_ptr<HapticDevice>> make(
      const std::shared_ptr<DeviceDriver>& driver, const DeviceModel& model, double period_s,
      std::optional<ArmingPermit> permit = std::nullopt,
      std::int64_t (*now_ns)() noexcept = &monotonicNow_ns);

  /// Opens the device. Refused when an axis would fall between two sessions; a host must then hold
  /// it.
  [[nodiscard]] Expected<Done> open() override;
  /// Checks that the device is homed and that no drive is in fault.
  [[nodiscard]] Expected<Done> ready() override;
  [[nodiscard]] Expected<Done> cleared() const override;
  /// Enables the device. Refused, and disabled again, when efforts do not reach the motors, or when
  /// a measured effort is not the neutral one.
  [[nodiscard]] Expected<Done> enable() override;
  /// Reads a sample. Sets kDeviceRead when the driver fails or an axis is missing; kDriveFault,
  /// kEnableLost and kDriveHot as the device reports; kStaleSample when a sample is older than
  /// longestStill_s() or from the future, or when samples stand still or go back in time;
  /// kSampleDelay when their mean age over the last tenth of a second exceeds the certificate's
  /// delay plus a period; kEffortAstray when three of the last seven measured efforts of an axis do
  /// not follow from the efforts sent (EffortJudge), or when an axis does not respond to changes of
  /// its effort as the passport says (ResponseJudge). The effort of an axis that the file does not
  /// list must stay as it was when the device was enabled.
  [[nodiscard]] Fault read(DeviceReading& reading, int elapsed_periods) noexcept override;
  [[nodiscard]] Fault write(const AxisEffort& effort) noexcept override;
  /// Disables the device; the driver stays open.
  void close() noexcept override;
  [[nodiscard]] const ArmingDelay& armingDelay() const noexcept override { return delay_; }

 private:
  PluginDevice(std::shared_ptr<DeviceDriver> driver, const DeviceModel& model, double period_s,
               ArmingDelay delay, std::int64_t (*now_ns)() noexcept);
  [[nodiscard]] Fault checkAge(const wh_sample& sample) noexcept;
  [[nodiscard]] Fault checkEfforts(const wh_sample& sample) noexcept;
  void beginEfforts(const wh_sample& sample) noexcept;
  void useMeasured(const DeviceModel& model);
  [[nodiscard]] Fault checkResponse(const AxisPosition& position, int elapsed_periods) noexcept;
  [[nodiscard]] Expected<Done> idle(const wh_sample& sample);
  [[nodiscard]] Expected<Done> mayFall() const;
  [[nodiscard]] Diagnostic no(const std::string& why, const std::string& remedy) const;
  [[nodiscard]] Fault check(const wh_sample& sample, int elapsed_periods) noexcept;

  std::shared_ptr<DeviceDriver> driver_;
  std::optional<ArmingPermit> permit_;
  ArmingDelay delay_;
  int axes_;
  double period_s_;
  double most_age_s_, most_mean_age_s_;
  int most_still_periods_;
  std::int64_t (*now_ns_)() noexcept;
  std::array<int, WH_MAX_AXES> place_{};  ///< for each axis of the file, the index of the driver's
                                          ///< axis
  wh_command neutral_{};
  bool open_ = false, enabled_ = false, begun_ = false;
  /// A sample arrived since the device was enabled. Some drives send one only after a command.
  bool current_ = false;
  int still_periods_ = 0;
  double mean_age_s_ = 0.0;
  wh_sample last_{};
  wh_command command_{};        ///< the last one that the driver accepted
  std::int64_t window_ns_;      ///< delay and 5 time constants of the drives
  std::int64_t judged_ns_ = 0;  ///< time of the last sample whose efforts were judged
  /// For each axis of the driver, the time of the last sample in which its drive derated.
  std::array<std::int64_t, WH_MAX_AXES> derated_ns_{};
  std::array<EffortTolerance, WH_MAX_AXES> tolerance_{};  ///< for each axis of the driver
  std::array<bool, WH_MAX_AXES> judged_{};                ///< this axis of the driver has a motor
  std::array<bool, WH_MAX_AXES> listed_{};  ///< the file lists this axis of the driver
  std::array<EffortJudge, WH_MAX_AXES> judges_{};
  ResponseJudge response_;
};

}  // namespace wholehand
