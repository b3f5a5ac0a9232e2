#include "devices/plugin/plugin_device.hpp"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <limits>
#include <string>
#include <utility>

namespace wholehand {
namespace {

constexpr double kTolerance = 1e-6;  // relative to the file's value
constexpr std::uint32_t kNeeded = WH_ENABLED | WH_HOMED;
constexpr double kMeanOver_s = 0.1;
// Tolerances of measured efforts: the sensor's, as a share of the effort limit, and the drive's
// gain, as a share of the effort sent.
constexpr double kSensorOfLimit = 0.1, kGainOfSent = 0.25;
constexpr double kLags = 5.0;               // time constants after which a drive has settled ..
constexpr double kUnsettled = 0.006737947;  // .. but for this share, e^-5

std::string number(double value) {
  std::array<char, 32> text{};
  std::snprintf(text.data(), text.size(), "%.6g", value);
  return text.data();
}

// True when the drive of this axis of the driver may give less effort.
bool derates(const wh_sample& sample, std::size_t axis) noexcept {
  if ((sample.status & WH_DERATING) == 0) return false;
  return sample.derating == 0 || (sample.derating >> axis & 1U) != 0;
}

class Comparison {
 public:
  Comparison(const DeviceModel& model, const DeviceDriver& driver)
      : model_(model), driver_(driver) {}

  void refuse(const DeviceAxis& axis, const std::string& why, const std::string& remedy) {
    out_.push_back({model_.path, 0, "axes", axis.name, driver_.where() + " " + why, remedy});
  }
  // Refuses a file that states more than the device has.
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
  const DeviceModel& model_;
  const DeviceDriver& driver_;
  Diagnostics out_;
};

}  // namespace

double longestStill_s(const DeviceModel& model) {
  constexpr double kWhereNothingIsStated_s = 0.02;
  return model.watch.longest_gap_s > 0.0 ? model.watch.longest_gap_s : kWhereNothingIsStated_s;
}

PluginDevice::PluginDevice(std::shared_ptr<DeviceDriver> driver, const DeviceModel& model,
                           double period_s, ArmingDelay delay, std::int64_t (*now_ns)() noexcept)
    : driver_(std::move(driver)),
      delay_(std::move(delay)),
      axes_(model.axisCount()),
      period_s_(period_s),
      most_age_s_(longestStill_s(model)),
      most_mean_age_s_((std::max(model.output_delay_ticks, delay_.periods) + 1) * period_s),
      most_still_periods_(static_cast<int>(std::ceil(most_age_s_ / period_s))),
      now_ns_(now_ns),
      window_ns_(static_cast<std::int64_t>(1e9 * (most_mean_age_s_ + kLags * model.drive_lag_s))) {
  neutral_.size = sizeof(neutral_);
  neutral_.axes = static_cast<std::uint32_t>(driver_->axes().size());
  for (std::size_t i = 0; i < driver_->axes().size(); ++i) {
    const wh_axis& axis = driver_->axes()[i];
    // What a brake, or an axis without a motor, measures is the person's.
    judged_[i] = axis.effort_meaning == WH_EFFORT && axis.effort_limit > 0.0;
    tolerance_[i].effort = kSensorOfLimit * axis.effort_limit;
  }
}

Expected<std::unique_ptr<HapticDevice>> PluginDevice::make(
    const std::shared_ptr<DeviceDriver>& driver, const DeviceModel& model, double period_s,
    std::optional<ArmingPermit> permit, std::int64_t (*now_ns)() noexcept) {
  Comparison compare(model, *driver);
  std::unique_ptr<PluginDevice> device(
      new PluginDevice(driver, model, period_s, permit ? permit->delay() : ArmingDelay{}, now_ns));
  device->permit_ = std::move(permit);
  const std::vector<wh_axis>& offered = driver->axes();
  for (int a = 0; a < model.axisCount(); ++a) {
    const DeviceAxis& axis = model.axes[a];
    const auto found = std::find_if(offered.begin(), offered.end(),
                                    [&](const wh_axis& has) { return axis.name == has.name; });
    if (found == offered.end()) {
      compare.refuse(axis, "has no such axis", "name the axes as the driver does");
      continue;
    }
    const auto place = static_cast<std::size_t>(found - offered.begin());
    device->place_[a] = static_cast<int>(place);
    device->listed_[place] = true;
    device->tolerance_[place] = {(kSensorOfLimit + 2.0 * kUnsettled) * axis.effort_limit,
                                 kGainOfSent};
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
    if (axis.neutral_effort != 0.0 && !driver->enablesAtNeutral()) {
      compare.refuse(axis, "enables it without its neutral effort, which would come in one step",
                     "give the driver wh_plugin.enable");
    }
    device->neutral_.effort[device->place_[a]] = axis.neutral_effort;
    compare.atLeast(axis, "travel down to", -found->lower, -axis.lower);
    compare.atLeast(axis, "travel up to", found->upper, axis.upper);
    compare.atLeast(axis, "an effort limit of", found->effort_limit, axis.effort_limit);
    compare.atMost(axis, "steps of position of", found->resolution, axis.encoder_step);
    compare.atMost(axis, "a delay of", found->delay_s, model.output_delay_ticks * period_s);
  }
  if (Diagnostics refused = compare.take(); !refused.empty()) return refused;
  device->useMeasured(model);
  return Expected<std::unique_ptr<HapticDevice>>(std::move(device));
}

// The judges use the figures of the passport. Without a passport nobody is attached.
void PluginDevice::useMeasured(const DeviceModel& model) {
  if (!permit_ || static_cast<int>(permit_->measured().size()) != axes_) return;
  ResponseJudge::Models models{};
  double lag_s = 0.0;
  for (int a = 0; a < axes_; ++a) {
    const MeasuredAxis& measured = permit_->measured()[static_cast<std::size_t>(a)];
    models[static_cast<std::size_t>(a)] = {measured.mass, measured.damping, measured.delay_s,
                                           model.axes[static_cast<std::size_t>(a)].effort_limit};
    lag_s = std::max(lag_s, measured.drive_lag_s);
  }
  response_ = ResponseJudge(models, axes_, period_s_);
  if (lag_s > 0.0) window_ns_ = static_cast<std::int64_t>(1e9 * (most_mean_age_s_ + kLags * lag_s));
}

Diagnostic PluginDevice::no(const std::string& why, const std::string& remedy) const {
  return fileFault(driver_->where(), why, remedy);
}

// Refuses when disabling would let an axis with weight fall. An axis that locks, or that a host
// holds, does not fall.
Expected<Done> PluginDevice::mayFall() const {
  if (driver_->holds()) return Done{};
  for (std::size_t i = 0; i < driver_->axes().size(); ++i) {
    const wh_axis& axis = driver_->axes()[i];
    if (neutral_.effort[i] == 0.0 || axis.disabled == WH_LOCKS || axis.disabled == WH_BALANCED) {
      continue;
    }
    return keyFault(driver_->where(), "axes", axis.name,
                    "weighs something and falls when the device is disabled",
                    "let a host hold it: wholehand device-host");
  }
  return Done{};
}

Expected<Done> PluginDevice::open() {
  if (open_) return Done{};
  if (Expected<Done> carried = mayFall(); !carried) return carried;
  begun_ = false;
  still_periods_ = 0;
  mean_age_s_ = 0.0;
  command_ = {};
  command_.size = sizeof(command_);
  command_.axes = static_cast<std::uint32_t>(driver_->axes().size());
  open_ = true;
  return Done{};
}

Expected<Done> PluginDevice::ready() {
  wh_sample sample{};
  if (driver_->read(sample) < 0) return no("the device gives no sample", "look at its cable");
  if ((sample.status & WH_DRIVE_FAULT) != 0) {
    return no("a drive is in fault, code " + std::to_string(sample.vendor_code),
              "clear it as its maker says");
  }
  if ((sample.status & WH_HOMED) == 0) return no("the device is not homed", "home it first");
  return Done{};
}

Expected<Done> PluginDevice::cleared() const {
  if (permit_) return Done{};
  return no("nobody has shown the passport and today's check of the device",
            "make the device with what checkArmingPermit() gives");
}

Expected<Done> PluginDevice::enable() {
  if (enabled_) return Done{};
  const auto undone = [this](Diagnostics why) {
    (void)driver_->control(WH_DISABLE, 0.0);
    return Expected<Done>(std::move(why));
  };
  if (Expected<Done> enabled = driver_->enable(neutral_); !enabled) {
    return undone(enabled.errors());
  }
  wh_sample sample{};
  if (driver_->read(sample) < 0) {
    return undone({no("the device gives no sample", "look at its cable")});
  }
  if ((sample.status & WH_ENABLED) == 0) {
    return undone({no("the device is not enabled",
                      "release its emergency stop, or press its enable button")});
  }
  beginEfforts(sample);
  if (Expected<Done> at_neutral = idle(sample); !at_neutral) return undone(at_neutral.errors());
  enabled_ = true;
  current_ = false;
  begun_ = true;
  last_ = sample;
  command_ = neutral_;
  return Done{};
}

// A disabled drive gives no effort; enabling brings the neutral one. An axis that the file does not
// list keeps what it gives.
void PluginDevice::beginEfforts(const wh_sample& sample) noexcept {
  judged_ns_ = sample.monotonic_ns;
  derated_ns_.fill(std::numeric_limits<std::int64_t>::min());
  for (std::size_t i = 0; i < driver_->axes().size(); ++i) {
    const double kept = std::isfinite(sample.effort[i]) ? sample.effort[i] : 0.0;
    judges_[i].begin(listed_[i] ? 0.0 : kept, listed_[i] ? neutral_.effort[i] : kept, now_ns_(),
                     tolerance_[i]);
  }
  AxisEffort neutral(axes_);
  for (int a = 0; a < axes_; ++a) neutral[a] = neutral_.effort[place_[a]];
  response_.send(neutral);
  response_.begin();
}

// Refuses an effort that is not the neutral one.
Expected<Done> PluginDevice::idle(const wh_sample& sample) {
  for (std::size_t i = 0; i < driver_->axes().size(); ++i) {
    if (judges_[i].allows(sample.effort[i], judged_ns_ - window_ns_, derates(sample, i))) continue;
    const wh_axis& axis = driver_->axes()[i];
    return keyFault(driver_->where(), "axes", axis.name,
                    "measures an effort of " + number(sample.effort[i]) + " at neutral, " +
                        number(neutral_.effort[i]),
                    "tare its sensor, or have the drive looked at");
  }
  return Done{};
}

Fault PluginDevice::check(const wh_sample& sample, int elapsed_periods) noexcept {
  Fault faults = Fault::kNone;
  if ((sample.status & WH_DRIVE_FAULT) != 0) faults |= Fault::kDriveFault;
  const bool reaches = (sample.status & kNeeded) == kNeeded && (sample.status & WH_SILENCED) == 0;
  if (enabled_ && !reaches) faults |= Fault::kEnableLost;
  if ((sample.status & (WH_HOT | WH_DERATING)) != 0) faults |= Fault::kDriveHot;
  if (!begun_) return faults;
  const bool newer = sample.sequence > last_.sequence;
  still_periods_ = newer ? 0 : still_periods_ + elapsed_periods;
  const bool backwards =
      sample.sequence < last_.sequence || sample.monotonic_ns < last_.monotonic_ns;
  if (backwards || still_periods_ > most_still_periods_) faults |= Fault::kStaleSample;
  current_ = current_ || newer;
  return current_ ? faults | checkAge(sample) | checkEfforts(sample) : faults;
}

// Checks times instead of sequence numbers: a driver may also count repeated samples.
Fault PluginDevice::checkAge(const wh_sample& sample) noexcept {
  const double age_s = static_cast<double>(now_ns_() - sample.monotonic_ns) * 1e-9;
  mean_age_s_ += std::min(period_s_ / kMeanOver_s, 1.0) * (age_s - mean_age_s_);
  if (age_s > most_age_s_ || age_s < -period_s_) return Fault::kStaleSample;
  return mean_age_s_ > most_mean_age_s_ ? Fault::kSampleDelay : Fault::kNone;
}

// Judges every sample once. An effort acts late, so a drive that derated may still give less.
Fault PluginDevice::checkEfforts(const wh_sample& sample) noexcept {
  if (!enabled_ || sample.monotonic_ns <= judged_ns_) return Fault::kNone;
  judged_ns_ = sample.monotonic_ns;
  const std::int64_t since_ns = judged_ns_ - window_ns_;
  Fault faults = Fault::kNone;
  for (std::size_t i = 0; i < driver_->axes().size(); ++i) {
    if (!judged_[i]) continue;
    if (derates(sample, i)) derated_ns_[i] = judged_ns_;
    if (judges_[i].isAstray(sample.effort[i], since_ns, derated_ns_[i] >= since_ns)) {
      faults |= Fault::kEffortAstray;
    }
  }
  return faults;
}

// Judges every period, with the effort that was in force in it. A gap leaves nothing to compare.
Fault PluginDevice::checkResponse(const AxisPosition& position, int elapsed_periods) noexcept {
  if (!enabled_) return Fault::kNone;
  if (!allFinite(position) || elapsed_periods > 1) response_.begin();
  if (!allFinite(position)) return Fault::kNone;
  return response_.isAstray(position) ? Fault::kEffortAstray : Fault::kNone;
}

Fault PluginDevice::read(DeviceReading& reading, int elapsed_periods) noexcept {
  wh_sample sample{};
  if (!open_ || driver_->read(sample) < 0) return Fault::kDeviceRead;
  if (reading.q_m.size() != axes_) reading.q_m = AxisPosition(axes_);
  for (int a = 0; a < axes_; ++a) {
    const auto from = static_cast<std::size_t>(place_[a]);
    if ((sample.valid >> from & 1U) == 0) return Fault::kDeviceRead;
    reading.q_m[a] = sample.position[from];
  }
  const Fault faults = check(sample, elapsed_periods) | checkResponse(reading.q_m, elapsed_periods);
  begun_ = true;
  last_ = sample;
  return faults;
}

Fault PluginDevice::write(const AxisEffort& effort) noexcept {
  if (!enabled_) return Fault::kDeviceWrite;
  ++command_.sequence;
  wh_command command = command_;
  for (int a = 0; a < axes_; ++a) command.effort[place_[a]] = effort[a];
  if (driver_->write(command) < 0) return Fault::kDeviceWrite;  // it holds the last one
  command_ = command;
  const std::int64_t now_ns = now_ns_();
  for (int a = 0; a < axes_; ++a) {
    judges_[static_cast<std::size_t>(place_[a])].send(effort[a], now_ns);
  }
  response_.send(effort);
  return Fault::kNone;
}

void PluginDevice::close() noexcept {
  open_ = false;
  if (!std::exchange(enabled_, false)) return;
  (void)driver_->control(WH_DISABLE, 0.0);
}

}  // namespace wholehand
