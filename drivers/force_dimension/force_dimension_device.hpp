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

/// A Force Dimension device as device.h wants a driver: x, y, z and, where the settings say so, the
/// gripper. The SDK's functions may wait for the USB bus and for their time guard: it runs in a
/// device host, never in the loop. One thread.
class ForceDimensionDevice {
 public:
  using Say = std::function<void(const std::string&)>;

  /// Opens the device: the first one, or that of a serial number. Moves nothing and switches no
  /// force on. Refused by name: no device, another serial number, no gripper where one is asked
  /// for.
  /// @param locator "" or "serial:12345"
  [[nodiscard]] static Expected<std::unique_ptr<ForceDimensionDevice>> open(
      Sdk sdk, const ForceSettings& settings, const std::string& locator, Say say);
  /// Force off, closed.
  ~ForceDimensionDevice();
  ForceDimensionDevice(const ForceDimensionDevice&) = delete;
  ForceDimensionDevice& operator=(const ForceDimensionDevice&) = delete;

  /// wh_plugin.describe, control, read, write.
  void describe(wh_axis* axes, std::uint32_t capacity, std::uint32_t& count) const;
  /// WH_ENABLE: force on, at zero. WH_DISABLE: zero, then off. WH_HOME: the SDK's calibration,
  /// which moves the device; force is off after it. WH_DROP_WATCHDOG: no force is sent any more.
  [[nodiscard]] int control(std::uint32_t verb);
  /// The SDK's time guard is WH_NOTHING_NEW.
  [[nodiscard]] int read(wh_sample& sample);
  [[nodiscard]] int write(const wh_command& command);
  /// Serial number and SDK; the SDK reports nothing of the firmware. Waits.
  void identify(wh_identity& identity);

 private:
  ForceDimensionDevice(Sdk sdk, const ForceSettings& settings, Say say)
      : sdk_(std::move(sdk)), settings_(settings), say_(std::move(say)) {}
  [[nodiscard]] Diagnostics find(const std::string& locator);
  [[nodiscard]] Diagnostics openSerial(unsigned wanted);
  [[nodiscard]] Diagnostics prepare();
  [[nodiscard]] int enable();
  [[nodiscard]] int disable();
  [[nodiscard]] int home();
  [[nodiscard]] int failed(const char* what);
  [[nodiscard]] int send(const std::array<double, 4>& effort);
  void sayWhyForceIsOff();
  [[nodiscard]] bool readPositions(wh_sample& sample, bool& nothing_new);
  [[nodiscard]] std::uint32_t statusBits(const std::array<int, kStatusRoom>& status);
  [[nodiscard]] double gripperSign() const { return left_handed_ ? -1.0 : 1.0; }
  [[nodiscard]] std::uint32_t axes() const { return settings_.gripper ? 4 : 3; }

  Sdk sdk_;
  ForceSettings settings_;
  Say say_;
  std::optional<char> id_;
  bool left_handed_ = false;
  bool homed_ = false, wanted_on_ = false, feeds_ = true, saturated_ = false;
  double cos_yaw_ = 1.0, sin_yaw_ = 0.0;
  std::uint64_t sequence_ = 0;
  wh_sample last_{};
};

}  // namespace wholehand::force_dimension
