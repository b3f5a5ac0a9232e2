#pragma once

#include "devices/plugin/device_driver.hpp"

#include <atomic>
#include <cstdint>
#include <cstring>
#include <string>
#include <vector>

namespace wholehand::test {

/// A rail of 20 cm with an effort limit of 8 N.
inline wh_axis plainAxis() {
  wh_axis axis{};
  axis.size = sizeof(axis);
  axis.lower = -0.1, axis.upper = 0.1;
  axis.effort_limit = 8.0;
  axis.silence_s = 0.02;
  return axis;
}

/// A driver of equal axes that are enabled together.
class PlainDriver : public DeviceDriver {
 public:
  PlainDriver(const std::vector<const char*>& names, wh_axis axis) {
    for (const char* name : names) {
      std::strncpy(axis.name, name, sizeof(axis.name) - 1);
      axes_.push_back(axis);
    }
  }
  [[nodiscard]] std::string where() const override { return "the driver of the test"; }
  [[nodiscard]] std::string name() const override { return "plain"; }
  [[nodiscard]] const std::vector<wh_axis>& axes() const noexcept override { return axes_; }
  [[nodiscard]] Expected<Done> control(std::uint32_t verb, double) override {
    enabled = verb == WH_ENABLE;
    return Done{};
  }

  std::atomic<bool> enabled{false};

 private:
  std::vector<wh_axis> axes_;
};

}  // namespace wholehand::test
