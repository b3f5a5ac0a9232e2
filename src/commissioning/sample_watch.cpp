#include "commissioning/sample_watch.hpp"

#include "device/plugin/plugin_device.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <utility>

namespace wholehand {
namespace {

constexpr double kSpeedOver_s = 0.01;  // window of the speed check
constexpr double kJump = 3.0;          // of the speed limit: no mechanism moves so
constexpr std::int64_t kAhead_ns = 1'000'000;

double inSeconds(std::int64_t ns) {
  return static_cast<double>(ns) * 1e-9;
}

}  // namespace

SampleWatch::SampleWatch(const DeviceModel& model, std::vector<std::size_t> place, double period_s)
    : model_(&model), place_(std::move(place)), period_s_(period_s) {
  begin();
}

void SampleWatch::begin() {
  seen_.clear();
  start_.clear();
  tick_ = still_ = 0;
  longest_gap_ns_ = 0;
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
  if ((sample.status & WH_SILENCED) != 0) {
    return no("",
              fmt::format("its watchdog let go; this program was silent for {:.1f} ms at most",
                          1e3 * inSeconds(longest_gap_ns_)),
              "let nothing else run on this machine, and repeat the step");
  }
  if ((sample.status & WH_HOMED) == 0) {
    return no("", "it is not homed any more", "repeat from the step `home` on");
  }
  if ((sample.status & WH_ENABLED) == 0) {
    return no("", "efforts do not reach the motors",
              "release its stop button, and repeat the step");
  }
  return Done{};
}

// Stillness is counted in ticks, not time: a stall of this machine is no stall of the device.
Expected<Done> SampleWatch::judgeAge(const wh_sample& sample, std::int64_t now_ns) {
  const bool first = tick_ == 0;
  const std::int64_t gap_ns = first ? 0 : now_ns - now_ns_;
  longest_gap_ns_ = std::max(longest_gap_ns_, gap_ns);
  const bool backwards = !first && (sample.sequence < sequence_ || sample.monotonic_ns < taken_ns_);
  const bool fresh = first || sample.sequence > sequence_;
  still_ = fresh ? 0 : still_ + 1;
  sequence_ = sample.sequence;
  taken_ns_ = sample.monotonic_ns;
  now_ns_ = now_ns;
  if (backwards) return no("", "its samples run backwards", "look at the driver");
  if (sample.monotonic_ns > now_ns + kAhead_ns) {
    return no("", "its samples' times lie in the future", "let the driver use CLOCK_MONOTONIC");
  }
  const double old_s = inSeconds(now_ns - sample.monotonic_ns);
  if (fresh && old_s > longestStill_s(*model_) + inSeconds(gap_ns)) {
    return no("", fmt::format("its samples are {:.0f} ms old when they come", 1e3 * old_s),
              "let the driver state when a sample was taken, or use a faster line");
  }
  if (static_cast<double>(still_) * period_s_ <= longestStill_s(*model_)) return Done{};
  return no("", "its samples stand still: nobody knows where it is",
            "look at its cable, and repeat the step");
}

Expected<Done> SampleWatch::judgeMotion(std::size_t i, const Seen& now) const {
  const DeviceAxis& axis = model_->axes[i];
  // A person may have left the axis at a stop; it may return from there.
  const double lower = std::min(axis.lower, start_[i]), upper = std::max(axis.upper, start_[i]);
  const double at = now.position[i];
  if (std::max(at - upper, lower - at) > axis.workspace_margin) {
    return no(axis.name, "is beyond its range", "bring it back by hand, and repeat the step");
  }
  if (seen_.empty()) return Done{};
  // Motion since another sample, over the most that the speed limit allows between their times.
  const auto excess = [&](const Seen& then, double times) {
    const double most = times * axis.speed_limit * inSeconds(now.taken_ns - then.taken_ns);
    return std::abs(at - then.position[i]) - most - 3.0 * axis.encoder_step;
  };
  if (excess(seen_.back(), kJump) > 0.0) {
    return no(axis.name, "its encoder jumps", "look at its encoder and the cable");
  }
  const bool long_enough = inSeconds(now.taken_ns - seen_.front().taken_ns) >= kSpeedOver_s;
  if (long_enough && excess(seen_.front(), 1.0) > 0.0) {
    return no(axis.name, "is faster than its speed limit: it runs away",
              "look at its signs, and repeat from the step `signs` on");
  }
  return Done{};
}

Expected<std::vector<double>> SampleWatch::judge(const wh_sample& sample, std::int64_t now_ns) {
  const bool same = tick_ > 0 && sample.monotonic_ns == taken_ns_;
  if (auto good = judgeAge(sample, now_ns); !good) return good.errors();
  if (auto good = judgeStatus(sample); !good) return good.errors();
  Expected<std::vector<double>> position = positions(sample);
  if (!position) return position;
  if (start_.empty()) start_ = *position;
  ++tick_;
  if (same) return position;
  const Seen now{sample.monotonic_ns, *position};
  for (std::size_t i = 0; i < place_.size(); ++i) {
    if (auto good = judgeMotion(i, now); !good) return good.errors();
  }
  const auto old = [&](const Seen& then) {
    return inSeconds(now.taken_ns - then.taken_ns) >= kSpeedOver_s;
  };
  seen_.push_back(now);
  while (seen_.size() > 1 && old(seen_[1])) seen_.pop_front();
  return position;
}

}  // namespace wholehand
