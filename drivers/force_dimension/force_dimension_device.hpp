#pragma once

#include "force_settings.hpp"
#include "loop/core/expected.hpp"
#include "sdk.hpp"
#include "wholehand/device.h"

#include <array>
#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <string>

namespace wholehand::force_dimension {

/// A Force Dimension device with the interface of device.h: x, y, z and, if the settings say so,
/// the gripper. The SDK's functions may wait for the USB bus and for their time guard. The driver
/// therefore runs in a device host, never in the loop. One thread.
class ForceDimensionDevice {
 public:
  using Report = std::function<void(const std::string&)>;

  /// Opens the first device, or the one with a given serial number. It does not move the device and
  /// switches no force on. Refused, each by name: no device, another serial number, a gripper that
  /// is requested but missing.
  /// @param locator "" or "serial:12345"
  [[nodiscard]] static Expected<std::unique_ptr<ForceDimensionDevice>> open(
      Sdk sdk, const ForceSettings& settings, const std::string& locator, Report report);
  /// Switches the force off and closes the device.
  ~ForceDimensionDevice();
  ForceDimensionDevice(const ForceDimensionDevice&) = delete;
  ForceDimensionDevice& operator=(const ForceDimensionDevice&) = delete;

  /// Implements wh_plugin.describe, control, read, write.
  void describe(wh_axis* axes, std::uint32_t capacity, std::uint32_t& count) const;
  /// WH_ENABLE: force on, at zero. WH_DISABLE: zero, then off. WH_HOME: the SDK's calibration,
  /// which moves the device; force is off afterwards. WH_DROP_WATCHDOG: no more force is sent.
  [[nodiscard]] int control(std::uint32_t verb);
  /// Reads a sample; WH_NOTHING_NEW when the SDK's time guard reports a call too early.
  [[nodiscard]] int read(wh_sample& sample);
  [[nodiscard]] int write(const wh_command& command);
  /// Writes the serial number and the SDK's version; the SDK reports nothing about the firmware.
  /// Waits.
  void identify(wh_identity& identity);

 private:
  ForceDimensionDevice(Sdk sdk, const ForceSettings& settings, Report report)
      : sdk_(std::move(sdk)), settings_(settings), report_(std::move(report)) {}
  [[nodiscard]] Diagnostics find(const std::string& locator);
  [[nodiscard]] Diagnostics openSerial(unsigned wanted);
  [[nodiscard]] Diagnostics prepare();
  [[nodiscard]] int enable();
  [[nodiscard]] int disable();
  [[nodiscard]] int home();
  [[nodiscard]] int failed(const char* what);
  [[nodiscard]] int send(const std::array<double, 4>& effort);
  void reportForceOff();
  [[nodiscard]] bool readPositions(wh_sample& sample, bool& nothing_new);
  [[nodiscard]] std::uint32_t statusBits(const std::array<int, kStatusRoom>& status);
  [[nodiscard]] double gripperSign() const { return left_handed_ ? -1.0 : 1.0; }
  [[nodiscard]] std::uint32_t axes() const { return settings_.gripper ? 4 : 3; }

  Sdk sdk_;
  ForceSettings settings_;
  Report report_;
  std::optional<char> id_;
  bool left_handed_ = false;
  bool homed_ = false, wanted_on_ = false, feeds_ = true, saturated_ = false;
  double cos_yaw_ = 1.0, sin_yaw_ = 0.0;
  std::uint64_t sequence_ = 0;
  wh_sample last_{};
};

}  // namespace wholehand::force_dimension
