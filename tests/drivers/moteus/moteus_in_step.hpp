#pragma once

#include "devices/plugin/device_driver.hpp"
#include "fake_drive.hpp"
#include "hand_settings.hpp"
#include "moteus/moteus_device.hpp"

#include <cstdint>
#include <memory>
#include <string>
#include <vector>

namespace wholehand::test {

/// The driver's code, called directly by the test on its clock instead of through the shared
/// object.
class MoteusInStep final : public DeviceDriver {
 public:
  MoteusInStep(FakeBusState& bus, SimulatedTime& time)
      : device_(handSettings(), std::make_unique<FakeBus>(bus, time),
                std::make_unique<SimulatedClock>(time), [](const std::string&) {}),
        axes_(3) {
    std::uint32_t count = 0;
    device_.describe(axes_.data(), 3, count);
  }
  [[nodiscard]] std::string where() const override { return "the driver in step"; }
  [[nodiscard]] std::string name() const override { return "moteus drives"; }
  [[nodiscard]] const std::vector<wh_axis>& axes() const noexcept override { return axes_; }
  [[nodiscard]] Expected<Done> control(std::uint32_t verb, double) override {
    if (device_.control(verb) == WH_OK) return Done{};
    return fileFault("", "control failed", "");
  }
  [[nodiscard]] int read(wh_sample& sample) noexcept override { return device_.read(sample); }
  [[nodiscard]] int write(const wh_command& command) noexcept override {
    return device_.write(command);
  }

 private:
  moteus::MoteusDevice device_;
  std::vector<wh_axis> axes_;
};

}  // namespace wholehand::test
