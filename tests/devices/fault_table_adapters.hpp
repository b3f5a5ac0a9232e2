#pragma once

#include "devices/plugin/plugin_device.hpp"
#include "devices/plugin/plugin_driver.hpp"

#include <memory>
#include <string>

/// Every shipped adapter, with a device behind it into which a test can inject faults.
namespace wholehand::test {

class FaultAdapter {
 public:
  virtual ~FaultAdapter() = default;
  [[nodiscard]] virtual std::shared_ptr<DeviceDriver> driver() = 0;
  [[nodiscard]] const DeviceModel& model() const { return model_; }
  /// Lets 1 ms pass.
  virtual void pass() { now_ns_ += 1'000'000; }
  /// The clock of the samples.
  [[nodiscard]] virtual std::int64_t now_ns() const { return now_ns_; }
  /// Gives the device this fault from now on.
  virtual void injectFault(const std::string& kind) = 0;
  [[nodiscard]] virtual bool inRealTime() const { return false; }

 protected:
  explicit FaultAdapter(DeviceModel model) : model_(std::move(model)) {}
  DeviceModel model_;

 private:
  std::int64_t now_ns_ = 1'000'000'000;
};

[[nodiscard]] std::unique_ptr<FaultAdapter> makeDirect();
[[nodiscard]] std::unique_ptr<FaultAdapter> makeComposite();
[[nodiscard]] std::unique_ptr<FaultAdapter> makeFrame();
[[nodiscard]] std::unique_ptr<FaultAdapter> makeMoteus();
[[nodiscard]] std::unique_ptr<FaultAdapter> makeForceDimension();
[[nodiscard]] std::unique_ptr<FaultAdapter> makeHosted();

/// Passes all calls on and interprets every sample by the rules of device.h.
class WatchedDriver final : public DeviceDriver {
 public:
  explicit WatchedDriver(std::shared_ptr<DeviceDriver> driver) : driver_(std::move(driver)) {}
  [[nodiscard]] std::string where() const override { return driver_->where(); }
  [[nodiscard]] std::string name() const override { return driver_->name(); }
  [[nodiscard]] const std::vector<wh_axis>& axes() const noexcept override {
    return driver_->axes();
  }
  [[nodiscard]] Expected<Done> control(std::uint32_t verb, double argument) override {
    return driver_->control(verb, argument);
  }
  [[nodiscard]] int read(wh_sample& sample) noexcept override {
    const int result = driver_->read(sample);
    reports_stop_ = result < 0;
    if (result < 0) return result;
    constexpr std::uint32_t kNeeded = WH_ENABLED | WH_HOMED;
    if ((sample.status & kNeeded) != kNeeded) reports_stop_ = true;
    if ((sample.status & (WH_DRIVE_FAULT | WH_SILENCED)) != 0) reports_stop_ = true;
    if ((sample.valid & missed_) != missed_) reports_stop_ = true;
    missed_ = sample.valid;
    if (known_ && (sample.sequence < last_.sequence || sample.monotonic_ns < last_.monotonic_ns)) {
      reports_stop_ = true;
    }
    still_ = known_ && sample.sequence == last_.sequence ? still_ + 1 : 0;
    if (still_ > 20) reports_stop_ = true;
    known_ = true;
    last_ = sample;
    return result;
  }
  [[nodiscard]] int write(const wh_command& command) noexcept override {
    return driver_->write(command);
  }
  /// Whether the last sample read reports a stop.
  [[nodiscard]] bool reportsStop() const { return reports_stop_; }

 private:
  std::shared_ptr<DeviceDriver> driver_;
  bool reports_stop_ = false, known_ = false;
  int still_ = 0;
  std::uint32_t missed_ = 0;  ///< axes that have been valid
  wh_sample last_{};
};

}  // namespace wholehand::test
