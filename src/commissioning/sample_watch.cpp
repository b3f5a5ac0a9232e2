#include "commissioning/sample_watch.hpp"

#include "device/plugin/plugin_device.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <utility>

namespace wholehand {
namespace {

constexpr double kSpeedOver_s = 0.01;  // window of the speed check
constexpr std::uint32_t kNeeded = WH_ENABLED | WH_HOMED;

}  // namespace

SampleWatch::SampleWatch(const DeviceModel& model, std::vector<std::size_t> place, double period_s)
    : model_(&model), place_(std::move(place)), period_s_(period_s) {
  begin();
}

void SampleWatch::begin() {
  const auto window = static_cast<std::size_t>(kSpeedOver_s / period_s_);
  seen_.assign(std::max<std::size_t>(1, window), {});
  start_.clear();
  tick_ = still_ = 0;
}

Diagnostic SampleWatch::no(const std::string& axis, const std::string& problem,
                           const std::string& remedy) const {
  return {model_->path, 0, axis.empty() ? "" : "axes", axis, problem, remedy};
}

Expected<std::vector<double>> SampleWatch::positions(const wh_sample& sample) const {
  std::vector<double> out;
  for (std::size_t i = 0; i < place_.size(); ++i) {
    const bool valid = (sample.valid >> place_[i] & 1U) != 0;
    if (!valid || !std::isfinite(sample.position[place_[i]])) {
      return no(model_->axes[i].name, "the device gives no position", "look at its encoder");
    }
    out.push_back(sample.position[place_[i]]);
  }
  return out;
}

Expected<Done> SampleWatch::judgeStatus(const wh_sample& sample) const {
  if ((sample.status & WH_DRIVE_FAULT) != 0) {
    return no("", fmt::format("a drive is in fault, code {}", sample.vendor_code),
              "clear it as its maker says");
  }
  if ((sample.status & kNeeded) != kNeeded || (sample.status & WH_SILENCED) != 0) {
    return no("", "efforts do not reach the motors, or the device is not homed",
              "release its stop button, and repeat the step");
  }
  return Done{};
}

// Counts ticks, not time: a stall of this machine is no stall of the device.
Expected<Done> SampleWatch::judgeAge(const wh_sample& sample) {
  const bool first = tick_ == 0;
  const bool backwards = !first && (sample.sequence < sequence_ || sample.monotonic_ns < taken_ns_);
  still_ = first || sample.sequence > sequence_ ? 0 : still_ + 1;
  sequence_ = sample.sequence;
  taken_ns_ = sample.monotonic_ns;
  if (backwards) return no("", "its samples run backwards", "look at the driver");
  if (static_cast<double>(still_) * period_s_ <= longestStill_s(*model_)) return Done{};
  return no("", "its samples stand still: nobody knows where it is",
            "look at its cable, and repeat the step");
}

Expected<Done> SampleWatch::judgeMotion(const std::vector<double>& now) {
  if (start_.empty()) start_ = now;
  std::vector<double>& before = seen_[tick_ % seen_.size()];
  for (std::size_t i = 0; i < now.size(); ++i) {
    const DeviceAxis& axis = model_->axes[i];
    // A person may have left the axis at a stop; it may return from there.
    const double lower = std::min(axis.lower, start_[i]), upper = std::max(axis.upper, start_[i]);
    if (std::max(now[i] - upper, lower - now[i]) > axis.workspace_margin) {
      return no(axis.name, "is beyond its range", "bring it back by hand, and repeat the step");
    }
    if (before.empty()) continue;
    const double most = axis.speed_limit * kSpeedOver_s + 3.0 * axis.encoder_step;
    if (std::abs(now[i] - before[i]) > most) {
      return no(axis.name, "is faster than its speed limit: it runs away, or its encoder jumps",
                "look at its signs, its encoder and the cable, and repeat from the signs on");
    }
  }
  before = now;
  return Done{};
}

Expected<std::vector<double>> SampleWatch::judge(const wh_sample& sample) {
  if (auto good = judgeStatus(sample); !good) return good.errors();
  if (auto good = judgeAge(sample); !good) return good.errors();
  Expected<std::vector<double>> now = positions(sample);
  if (!now) return now;
  if (auto good = judgeMotion(*now); !good) return good.errors();
  ++tick_;
  return now;
}

}  // namespace wholehand
