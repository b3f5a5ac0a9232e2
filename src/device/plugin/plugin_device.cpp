#include "device/plugin/plugin_device.hpp"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <string>
#include <utility>

namespace wholehand {
namespace {

constexpr double kTolerance = 1e-6;  // relative to the file's value
constexpr std::uint32_t kNeeded = WH_ENABLED | WH_HOMED;

class Comparison {
 public:
  Comparison(const DeviceModel& model, const DeviceDriver& driver)
      : model_(model), driver_(driver) {}

  void refuse(const DeviceAxis& axis, const std::string& why, const std::string& remedy) {
    out_.push_back({model_.path, 0, "axes", axis.name, driver_.where() + " " + why, remedy});
  }
  // The file must not state more than the device has.
  void atLeast(const DeviceAxis& axis, const char* what, double has, double stated) {
    if (has >= stated - kTolerance * std::max(1.0, std::abs(stated))) return;
    refuse(axis,
           std::string("has ") + what + " " + number(has) + ", the file states " + number(stated),
           "state what the device has");
  }
  void atMost(const DeviceAxis& axis, const char* what, double has, double stated) {
    if (has <= stated * (1.0 + 1e-3) + 1e-12) return;
    refuse(axis,
           std::string("has ") + what + " " + number(has) + ", the file states " + number(stated),
           "state what the device has, and certify again");
  }
  [[nodiscard]] Diagnostics take() { return std::move(out_); }

 private:
  static std::string number(double value) {
    std::array<char, 32> text{};
    std::snprintf(text.data(), text.size(), "%.6g", value);
    return text.data();
  }

  const DeviceModel& model_;
  const DeviceDriver& driver_;
  Diagnostics out_;
};

}  // namespace

double longestStill_s(const DeviceModel& model) {
  constexpr double kWhereNothingIsStated_s = 0.02;
  return model.watch.longest_gap_s > 0.0 ? model.watch.longest_gap_s : kWhereNothingIsStated_s;
}

Expected<std::unique_ptr<HapticDevice>> PluginDevice::make(
    const std::shared_ptr<DeviceDriver>& driver, const DeviceModel& model, double period_s) {
  Comparison compare(model, *driver);
  std::unique_ptr<PluginDevice> device(new PluginDevice(
      driver, model.axisCount(), static_cast<int>(std::ceil(longestStill_s(model) / period_s))));
  const std::vector<wh_axis>& offered = driver->axes();
  for (int a = 0; a < model.axisCount(); ++a) {
    const DeviceAxis& axis = model.axes[a];
    const auto found = std::find_if(offered.begin(), offered.end(),
                                    [&](const wh_axis& has) { return axis.name == has.name; });
    if (found == offered.end()) {
      compare.refuse(axis, "has no such axis", "name the axes as the driver does");
      continue;
    }
    device->place_[a] = static_cast<int>(found - offered.begin());
    const bool turns = axis.kind == AxisKind::kRotation;
    if ((found->kind == WH_ROTATION) != turns) {
      compare.refuse(axis, turns ? "has a translation" : "has a rotation",
                     "give the axis its kind");
    }
    if (found->effort_meaning != WH_EFFORT) {
      compare.refuse(axis, "takes no effort there, but a limit of position, a brake or a vibration",
                     "leave the axis out");
    }
    if (!(found->silence_s > 0.0)) {
      compare.refuse(axis, "has no watchdog: its last effort would stay when the program dies",
                     "switch the drive's watchdog on");
    }
    compare.atLeast(axis, "travel down to", -found->lower, -axis.lower);
    compare.atLeast(axis, "travel up to", found->upper, axis.upper);
    compare.atLeast(axis, "an effort limit of", found->effort_limit, axis.effort_limit);
    compare.atMost(axis, "steps of position of", found->resolution, axis.encoder_step);
    compare.atMost(axis, "a delay of", found->delay_s, model.output_delay_ticks * period_s);
  }
  if (Diagnostics refused = compare.take(); !refused.empty()) return refused;
  return Expected<std::unique_ptr<HapticDevice>>(std::move(device));
}

Expected<Done> PluginDevice::open() {
  if (enabled_) return Done{};
  begun_ = false;
  still_periods_ = 0;
  command_ = {};
  command_.size = sizeof(command_);
  command_.axes = static_cast<std::uint32_t>(driver_->axes().size());
  Expected<Done> enabled = driver_->control(WH_ENABLE, 0.0);
  enabled_ = enabled.ok();
  return enabled;
}

Expected<Done> PluginDevice::ready() {
  wh_sample sample{};
  const auto no = [this](const std::string& why, const std::string& remedy) {
    return Diagnostic{driver_->where(), 0, "", "", why, remedy};
  };
  if (driver_->read(sample) < 0) return no("the device gives no sample", "look at its cable");
  if ((sample.status & WH_DRIVE_FAULT) != 0) {
    return no("a drive is in fault, code " + std::to_string(sample.vendor_code),
              "clear it as its maker says");
  }
  if ((sample.status & WH_HOMED) == 0) return no("the device is not homed", "home it first");
  if ((sample.status & WH_ENABLED) == 0) {
    return no("the device is not enabled",
              "release its emergency stop, or press its enable button");
  }
  return Done{};
}

Fault PluginDevice::judge(const wh_sample& sample, int elapsed_periods) noexcept {
  Fault faults = Fault::kNone;
  if ((sample.status & WH_DRIVE_FAULT) != 0) faults |= Fault::kDriveFault;
  if ((sample.status & kNeeded) != kNeeded || (sample.status & WH_SILENCED) != 0) {
    faults |= Fault::kEnableLost;
  }
  if ((sample.status & (WH_HOT | WH_DERATING)) != 0) faults |= Fault::kDriveHot;
  if (!begun_) return faults;
  const bool newer = sample.sequence > last_.sequence;
  still_periods_ = newer ? 0 : still_periods_ + elapsed_periods;
  const bool backwards =
      sample.sequence < last_.sequence || sample.monotonic_ns < last_.monotonic_ns;
  if (backwards || still_periods_ > most_still_periods_) faults |= Fault::kStaleSample;
  return faults;
}

Fault PluginDevice::read(DeviceReading& reading, int elapsed_periods) noexcept {
  wh_sample sample{};
  if (!enabled_ || driver_->read(sample) < 0) return Fault::kDeviceRead;
  if (reading.q_m.size() != axes_) reading.q_m = AxisPosition(axes_);
  for (int a = 0; a < axes_; ++a) {
    const auto from = static_cast<std::size_t>(place_[a]);
    if ((sample.valid >> from & 1U) == 0) return Fault::kDeviceRead;
    reading.q_m[a] = sample.position[from];
  }
  const Fault faults = judge(sample, elapsed_periods);
  begun_ = true;
  last_ = sample;
  return faults;
}

Fault PluginDevice::write(const AxisEffort& effort) noexcept {
  if (!enabled_) return Fault::kDeviceWrite;
  ++command_.sequence;
  for (int a = 0; a < axes_; ++a) {
    command_.effort[place_[a]] = effort[a];
  }
  return driver_->write(command_) < 0 ? Fault::kDeviceWrite : Fault::kNone;
}

void PluginDevice::close() noexcept {
  if (!std::exchange(enabled_, false)) return;
  (void)driver_->control(WH_DISABLE, 0.0);
}

}  // namespace wholehand
