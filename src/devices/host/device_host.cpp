#include "devices/host/device_host.hpp"

#include <algorithm>
#include <cstring>
#include <exception>
#include <string>
#include <utility>

namespace wholehand {
namespace {

template <std::size_t N>
void copyText(char (&to)[N], const std::string& text) {
  const std::size_t length = std::min(text.size(), N - 1);
  std::memcpy(to, text.data(), length);
  std::memset(to + length, 0, N - length);
}

}  // namespace

const char* describe(ReleaseReason reason) noexcept {
  switch (reason) {
    case ReleaseReason::kNone:
      return "nothing";
    case ReleaseReason::kLoopSilent:
      return "the loop sent no new command for 20 ms";
    case ReleaseReason::kSilentAtNeutral:
      return "the loop sent no new command for 20 ms; the effort was neutral";
    case ReleaseReason::kBadCommand:
      return "the loop's command was not finite, or not of as many axes";
    case ReleaseReason::kLoopEnded:
      return "the loop ended before it was at neutral";
    case ReleaseReason::kHostEnds:
      return "the host was asked to end";
    case ReleaseReason::kNeverCommanded:
      return "the loop enabled the device and sent no command";
  }
  return "unknown";
}

GuardConfig guardConfig(const DeviceDriver& driver, const DeviceModel& model, double period_s) {
  const auto axes = static_cast<int>(driver.axes().size());
  GuardConfig config;
  config.period_s = period_s;
  config.neutral = AxisEffort(axes);
  config.limit = AxisEffort(axes);
  config.most_change = AxisEffort(axes);
  const double window_s = slewTicks(period_s) * period_s;
  for (int i = 0; i < axes; ++i) {
    const int at = model.axisIndex(driver.axes()[i].name);
    if (at < 0) continue;
    const DeviceAxis& axis = model.axes[at];
    config.neutral[i] = axis.neutral_effort;
    config.limit[i] = axis.effort_limit;
    config.most_change[i] = axis.effort_slew_limit * window_s;
  }
  return config;
}

void describeDevice(SharedFrame& frame, const DeviceDriver& driver, const GuardConfig& config,
                    std::int64_t host_pid) {
  frame.layout = kFrameLayout;
  frame.size = sizeof(SharedFrame);
  frame.host_pid = host_pid;
  frame.axis_count = static_cast<std::uint32_t>(driver.axes().size());
  copyText(frame.driver, driver.name());
  frame.identity.size = sizeof(frame.identity);
  copyText(frame.identity.serial, driver.identity().serial);
  copyText(frame.identity.firmware, driver.identity().firmware);
  copyText(frame.identity.sdk, driver.identity().sdk);
  copyText(frame.driver_sha256, driver.identity().driver_sha256);
  for (std::size_t i = 0; i < driver.axes().size(); ++i) {
    frame.axes[i] = driver.axes()[i];
    // A sample waits up to one cycle for the loop, and a command up to one cycle for the device.
    frame.axes[i].delay_s += 2.0 * config.period_s;
    frame.neutral[i] = config.neutral[static_cast<int>(i)];
    frame.limit[i] = config.limit[static_cast<int>(i)];
  }
  frame.magic.store(kFrameMagic, std::memory_order_release);
}

DeviceHost::DeviceHost(DeviceDriver& driver, SharedFrame& frame, const GuardConfig& config,
                       std::int64_t (*now_ns)() noexcept)
    : driver_(driver), frame_(frame), config_(config), now_ns_(now_ns) {
  guard_ = endSession(guard_, config_);
  out_.size = sizeof(out_);
  out_.axes = static_cast<std::uint32_t>(config_.neutral.size());
}

bool DeviceHost::cycle(int elapsed_periods) noexcept {
  const int read_result = driver_.read(sample_.sample);
  const std::int64_t now_ns = now_ns_();  // read late, because a driver may have blocked
  if (last_cycle_ns_ != 0) longest_gap_ns_ = std::max(longest_gap_ns_, now_ns - last_cycle_ns_);
  last_cycle_ns_ = now_ns;

  const HostPhase before = guard_.phase;
  (void)frame_.request.take(request_);
  bool asked = request_.number != answered_;
  const bool ending = end_.load(std::memory_order_acquire);
  ReleaseReason let_go = ReleaseReason::kNone;
  if (ending) let_go = ReleaseReason::kHostEnds;
  commanded_ = frame_.command.take(command_) || commanded_;
  if (asked && request_.verb == WH_DISABLE) {
    // The loop sent its last command before its end request. Both may arrive between two cycles, so
    // the command is taken first.
    if (commanded_ && isNew(command_)) {
      asked = false;
    } else {
      let_go = ReleaseReason::kLoopEnded;
    }
  }
  guard_ = advanceGuard(guard_, commanded_ ? &command_ : nullptr, let_go, elapsed_periods, now_ns,
                        config_);
  if (guard_.phase != HostPhase::kIdle || held_) {
    ++out_.sequence;
    for (int i = 0; i < config_.neutral.size(); ++i) {
      out_.effort[i] = guard_.ramp.sent[i];
    }
    sample_.write_result = driver_.write(out_);
  }
  if (asked && guard_.phase != HostPhase::kRamping) serve();
  reportChange(before, now_ns);
  publish(read_result, now_ns);
  if (!ending || guard_.phase == HostPhase::kRamping) return true;
  if (guard_.phase == HostPhase::kIdle && !held_) return false;
  (void)driver_.control(WH_DISABLE, 0.0);
  guard_ = endSession(guard_, config_);
  return false;
}

void DeviceHost::publish(int read_result, std::int64_t now_ns) noexcept {
  ++sample_.cycle;
  sample_.monotonic_ns = now_ns;
  sample_.session = guard_.session;
  sample_.phase = guard_.phase;
  sample_.reason = guard_.reason;
  sample_.read_result = read_result;
  frame_.sample.publish(sample_);
}

void DeviceHost::reportChange(HostPhase before, std::int64_t now_ns) noexcept {
  if (guard_.phase == before) return;
  HostEvent event;
  event.phase = guard_.phase;
  event.reason = guard_.reason;
  event.session = guard_.session;
  event.at_ns = now_ns;
  event.silent_ns = now_ns - guard_.last_command_ns;
  event.longest_gap_ns = longest_gap_ns_;
  event.loop_pid = request_.pid;
  longest_gap_ns_ = 0;
  (void)events_.try_push(event);
}

bool DeviceHost::isNew(const HostCommand& command) const noexcept {
  const bool hears = guard_.phase == HostPhase::kWaiting || guard_.phase == HostPhase::kRendering;
  return hears && command.session == guard_.session && command.sequence > guard_.sequence;
}

bool DeviceHost::isRendering() const noexcept {
  return guard_.phase == HostPhase::kRendering || guard_.phase == HostPhase::kRamping;
}

// Carries out a request of the loop. It takes as long as the driver needs; nothing is rendered
// meanwhile.
void DeviceHost::serve() {
  HostAnswer answer{};
  answer.number = request_.number;
  answer.session = guard_.session;
  try {
    carryOut(request_, answer);
  } catch (const std::exception& error) {
    copyText(answer.text, error.what());
  }
  answered_ = request_.number;
  last_cycle_ns_ = 0;  // the duration of a verb does not count as a gap
  frame_.answer.publish(answer);
}

void DeviceHost::carryOut(const HostRequest& request, HostAnswer& answer) {
  const auto verb = static_cast<std::uint32_t>(request.verb);
  if (verb != WH_DISABLE && isRendering()) {
    return copyText(answer.text, "the device renders; end that first");
  }
  if (end_.load(std::memory_order_acquire) && verb != WH_DISABLE) {
    return copyText(answer.text, "the host is ending");
  }
  const Expected<Done> done = verb == WH_ENABLE    ? enable()
                              : verb == WH_DISABLE ? disable()
                                                   : driver_.control(verb, request.argument);
  if (verb == WH_DISABLE) guard_ = endSession(guard_, config_);
  if (!done) return copyText(answer.text, done.errors().front().problem);
  answer.ok = 1;
  if (verb != WH_ENABLE) return;
  sample_.write_result = 0;
  guard_ = beginSession(++sessions_, now_ns_(), config_);
  answer.session = guard_.session;
}

Expected<Done> DeviceHost::enable() {
  if (std::exchange(held_, false)) return Done{};
  return driver_.enable(neutralOf(config_));
}

Expected<Done> DeviceHost::disable() {
  const bool weighs = std::any_of(config_.neutral.begin(), config_.neutral.end(),
                                  [](double effort) { return effort != 0.0; });
  held_ = held_ || (weighs && guard_.phase != HostPhase::kIdle);
  return held_ ? Expected<Done>(Done{}) : driver_.control(WH_DISABLE, 0.0);
}

}  // namespace wholehand
