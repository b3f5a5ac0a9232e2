#pragma once

#include "device/plugin/device_driver.hpp"

#include <atomic>
#include <cstdint>
#include <limits>
#include <memory>
#include <string>
#include <utility>
#include <vector>

namespace wholehand {

/// State of a device for display, beside its positions.
struct DeviceFacts {
  bool enabled = false, homed = false, silenced = false;
  /// Highest of all axes; NaN: unknown.
  double temperature_c = std::numeric_limits<double>::quiet_NaN();
  std::int64_t sampled_ns = 0;  ///< time of the newest sample, CLOCK_MONOTONIC; 0: none yet
};

/// A driver that publishes its newest sample's state to other threads, at the cost of a few stores
/// per tick.
class ObservedDriver final : public DeviceDriver {
 public:
  explicit ObservedDriver(std::shared_ptr<DeviceDriver> driver) : driver_(std::move(driver)) {}

  /// Any thread. Each field is of the newest sample; the fields are not read atomically together.
  [[nodiscard]] DeviceFacts facts() const noexcept;

  [[nodiscard]] std::string where() const override { return driver_->where(); }
  [[nodiscard]] std::string name() const override { return driver_->name(); }
  [[nodiscard]] const std::vector<wh_axis>& axes() const noexcept override {
    return driver_->axes();
  }
  [[nodiscard]] Expected<Done> reconnect() override { return driver_->reconnect(); }
  [[nodiscard]] Expected<Done> control(std::uint32_t verb, double argument) override;
  [[nodiscard]] Expected<Done> enable(const wh_command& neutral) override {
    return driver_->enable(neutral);
  }
  [[nodiscard]] bool enablesAtNeutral() const noexcept override {
    return driver_->enablesAtNeutral();
  }
  [[nodiscard]] bool holds() const noexcept override { return driver_->holds(); }
  [[nodiscard]] WHOLEHAND_RT int read(wh_sample& sample) noexcept override;
  [[nodiscard]] WHOLEHAND_RT int write(const wh_command& command) noexcept override {
    return driver_->write(command);
  }

 private:
  std::shared_ptr<DeviceDriver> driver_;
  std::atomic<std::uint32_t> status_{0};
  std::atomic<double> temperature_c_{std::numeric_limits<double>::quiet_NaN()};
  std::atomic<std::int64_t> sampled_ns_{0};
};

static_assert(std::atomic<double>::is_always_lock_free);
static_assert(std::atomic<std::int64_t>::is_always_lock_free);

}  // namespace wholehand
