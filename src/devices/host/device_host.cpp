#include "devices/host/device_host.hpp"

#include "devices/plugin/plugin_device.hpp"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <exception>
#include <string>
#include <utility>

namespace wholehand {
namespace {

// A shorter change of the drive's state is not reported: some drives are on a sample after
// WH_ENABLE.
constexpr std::int64_t kReportAfter_ns = 10'000'000;

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
  config.longest_still_ns = std::llround(longestStill_s(model) * 1e9);
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
  frame.switches_within_s = driver.switchesWithin_s();
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
  const bool written = shouldBeOn(guard_.phase, held_);
  if (written) {
    ++out_.sequence;
    for (int i = 0; i < config_.neutral.size(); ++i) {
      out_.effort[i] = guard_.ramp.sent[i];
    }
    sample_.write_result = driver_.write(out_);
  }
  if (commanded_) noteArrival();
  hearDrive(read_result, written, now_ns);
  if (asked && guard_.phase != HostPhase::kRamping) serve();
  reportChange(before, now_ns);
  reportDrive(now_ns);
  publish(read_result, now_ns);
  if (!ending || guard_.phase == HostPhase::kRamping) return true;
  if (guard_.phase == HostPhase::kIdle && !held_) return false;
  (void)driver_.control(WH_DISABLE, 0.0);
  guard_ = endSession(guard_, config_);
  return false;
}

// Tells the loop when its newest command was passed on, so that the loop knows the way's delay.
void DeviceHost::noteArrival() noexcept {
  const bool known = command_.session == arrived_session_ && command_.sequence == sample_.command;
  if (known) return;
  arrived_session_ = command_.session;
  sample_.command = command_.sequence;
  sample_.command_sent_ns = command_.monotonic_ns;
  sample_.command_arrived_ns = now_ns_();
}

void DeviceHost::publish(int read_result, std::int64_t now_ns) noexcept {
  ++sample_.cycle;
  sample_.monotonic_ns = now_ns;
  sample_.session = guard_.session;
  sample_.phase = guard_.phase;
  sample_.reason = guard_.reason;
  sample_.read_result = read_result;
  sample_.held = held_ ? 1 : 0;
  frame_.sample.publish(sample_);
}

DriveState DeviceHost::driveState(int read_result, bool written,
                                  std::int64_t now_ns) const noexcept {
  if (read_result < 0) return DriveState::kUnreadable;
  if (now_ns - still_since_ns_ > config_.longest_still_ns) return DriveState::kStill;
  const std::uint32_t status = sample_.sample.status;
  if ((status & WH_DRIVE_FAULT) != 0) return DriveState::kFault;
  if ((status & WH_SILENCED) != 0) return DriveState::kSilenced;
  if ((status & WH_ENABLED) == 0) return DriveState::kOff;
  return written && sample_.write_result < 0 ? DriveState::kRefuses : DriveState::kOn;
}

// Notes what the drive said in this cycle. Its samples count by their sequence: the times of a
// drive that gives nothing new may go on.
void DeviceHost::hearDrive(int read_result, bool written, std::int64_t now_ns) noexcept {
  const bool began = still_since_ns_ == 0;
  const bool first = sample_.drive_heard_ns == 0;
  const bool newer = read_result >= 0 && (first || sample_.sample.sequence != heard_);
  const bool refused = written && sample_.write_result < 0;
  if (newer || began) still_since_ns_ = now_ns;
  if (began || !written) asked_ns_ = now_ns;
  if (newer || refused) sample_.drive_heard_ns = now_ns;
  if (newer) heard_ = sample_.sample.sequence;
  const DriveState state = driveState(read_result, written, now_ns);
  if (state == sample_.drive) return;
  sample_.drive = state;
  sample_.drive_since_ns = now_ns;
}

// Reports a drive that should be on and is not, once for each state, and when it is on again.
void DeviceHost::reportDrive(std::int64_t now_ns) noexcept {
  if (!shouldBeOn(guard_.phase, held_)) {
    told_ = DriveState::kOn;
    return;
  }
  const std::int64_t since_ns = std::max(sample_.drive_since_ns, asked_ns_);
  if (sample_.drive == told_ || now_ns - since_ns < kReportAfter_ns) return;
  told_ = sample_.drive;
  HostEvent event;
  event.of_drive = true;
  event.phase = guard_.phase;
  event.drive = sample_.drive;
  event.session = guard_.session;
  event.at_ns = now_ns;
  event.heard_ns = now_ns - sample_.drive_heard_ns;
  (void)events_.try_push(event);
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
  last_cycle_ns_ = still_since_ns_ = 0;  // the duration of a verb does not count as a gap
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

// Enables the drive unless it is held and still on. A drive that let go may need WH_DISABLE before;
// that comes second, because a part of the device may still carry its weight.
Expected<Done> DeviceHost::enable() {
  if (held_ && sample_.drive == DriveState::kOn) {
    held_ = false;
    return Done{};
  }
  const wh_command neutral = neutralOf(config_);
  Expected<Done> enabled = driver_.enable(neutral);
  if (held_ && (!enabled || !isOn())) {
    (void)driver_.control(WH_DISABLE, 0.0);
    enabled = driver_.enable(neutral);
  }
  if (enabled) held_ = false;
  return enabled;
}

// True when a new reading says that efforts reach the motors.
bool DeviceHost::isOn() noexcept {
  constexpr std::uint32_t kOff = WH_SILENCED | WH_DRIVE_FAULT;
  wh_sample sample{};
  if (driver_.read(sample) < 0) return false;
  return (sample.status & WH_ENABLED) != 0 && (sample.status & kOff) == 0;
}

Expected<Done> DeviceHost::disable() {
  const bool weighs = std::any_of(config_.neutral.begin(), config_.neutral.end(),
                                  [](double effort) { return effort != 0.0; });
  held_ = held_ || (weighs && guard_.phase != HostPhase::kIdle);
  return held_ ? Expected<Done>(Done{}) : driver_.control(WH_DISABLE, 0.0);
}

}  // namespace wholehand
