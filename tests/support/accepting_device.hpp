#pragma once

#include "loop/device/haptic_device.hpp"

#include <cstring>

namespace wholehand::test {

/// Wraps a device and keeps the effort that it holds: the last accepted one, whatever the loop has
/// sent.
class AcceptingDevice final : public HapticDevice {
 public:
  /// @param as_opened the effort that the device holds after open()  @pre device outlives this
  AcceptingDevice(HapticDevice& device, const AxisEffort& as_opened)
      : device_(device), as_opened_(as_opened), held_(as_opened) {}

  [[nodiscard]] Expected<Done> open() override {
    held_ = as_opened_;
    return device_.open();
  }
  [[nodiscard]] Expected<Done> ready() override { return device_.ready(); }
  [[nodiscard]] Expected<Done> enable() override { return device_.enable(); }
  [[nodiscard]] bool simulated() const noexcept override { return device_.simulated(); }
  [[nodiscard]] Fault read(DeviceReading& reading, int elapsed_periods) noexcept override {
    return device_.read(reading, elapsed_periods);
  }
  [[nodiscard]] Fault write(const AxisEffort& effort) noexcept override {
    const Fault fault = device_.write(effort);
    if (!any(fault)) held_ = effort;
    return fault;
  }
  void close() noexcept override { device_.close(); }

  [[nodiscard]] const AxisEffort& held() const noexcept { return held_; }

 private:
  HapticDevice& device_;
  AxisEffort as_opened_, held_;
};

/// True if both are equal bit by bit.
inline bool same(const AxisEffort& a, const AxisEffort& b) noexcept {
  return a.size() == b.size() &&
         std::memcmp(a.data(), b.data(), sizeof(double) * static_cast<std::size_t>(a.size())) == 0;
}

}  // namespace wholehand::test
