#pragma once

#include "loop/device/haptic_device.hpp"

namespace wholehand::test {

/// A device that may move a person. It rests at one place and accepts every effort; tests override
/// what differs.
class RestingDevice : public HapticDevice {
 public:
  RestingDevice() = default;
  explicit RestingDevice(const AxisPosition& at) : at_(at) {}
  [[nodiscard]] Expected<Done> open() override { return Done{}; }
  [[nodiscard]] Expected<Done> ready() override { return Done{}; }
  [[nodiscard]] bool simulated() const noexcept override { return false; }
  [[nodiscard]] Fault read(DeviceReading& reading, int) noexcept override {
    reading.q_m = at_;
    return Fault::kNone;
  }
  [[nodiscard]] Fault write(const AxisEffort&) noexcept override { return Fault::kNone; }
  void close() noexcept override {}

 private:
  AxisPosition at_;
};

}  // namespace wholehand::test
