#pragma once

#include "core/expected.hpp"
#include "core/real_time.hpp"
#include "wholehand/device.h"

#include <cstdint>
#include <string>
#include <vector>

namespace wholehand {

/// Which device it is, by the driver's words; empty where they are not known.
struct DriverIdentity {
  std::string serial, firmware, sdk;
};

/// What control() says of a verb that the device does not know begins so.
inline constexpr const char* kHasNoWay = "the device has no way to ";

/// A driver by the boundary of device.h, wherever it runs: in this process, or in that of a host.
/// One thread at a time: control() is not called while a loop reads and writes.
class DeviceDriver {
 public:
  virtual ~DeviceDriver() = default;

  /// For messages: "the driver ./rails.so", "the host desk".
  [[nodiscard]] virtual std::string where() const = 0;
  /// What the driver calls itself.
  [[nodiscard]] virtual std::string name() const = 0;
  /// In the order of positions and efforts; they do not change.
  [[nodiscard]] virtual const std::vector<wh_axis>& axes() const noexcept = 0;
  /// One of the verbs of device.h; returns when it is done. Not real-time safe.
  [[nodiscard]] virtual Expected<Done> control(std::uint32_t verb, double argument) = 0;
  /// As wh_plugin.read and wh_plugin.write: 0 and more is success.
  [[nodiscard]] WHOLEHAND_RT virtual int read(wh_sample& sample) noexcept = 0;
  [[nodiscard]] WHOLEHAND_RT virtual int write(const wh_command& command) noexcept = 0;

  /// Known once the device is open; does not change.
  [[nodiscard]] const DriverIdentity& identity() const noexcept { return identity_; }

 protected:
  DriverIdentity identity_;
};

}  // namespace wholehand
