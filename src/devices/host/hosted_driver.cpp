#include "devices/host/hosted_driver.hpp"

#include "loop/realtime/monotonic_clock.hpp"

#include <algorithm>
#include <array>
#include <chrono>
#include <cmath>
#include <cstring>
#include <thread>
#include <unistd.h>
#include <utility>

namespace wholehand {
namespace {

constexpr std::chrono::milliseconds kAnswerEvery{1};
constexpr std::int64_t kAnswerWithin_ns = 120'000'000'000;  // homing moves the device
constexpr std::int64_t kEndWithin_ns = 3'000'000'000;       // a run waits this long at its end
constexpr std::int64_t kSampleWithin_ns = 2'000'000'000;

std::vector<wh_axis> axesOf(const SharedFrame& frame) {
  return {frame.axes, frame.axes + frame.axis_count};
}

DriverIdentity identityOf(const SharedFrame& frame) {
  const auto text = [](const auto& field) {
    return std::string(field, ::strnlen(field, sizeof(field)));
  };
  return {text(frame.identity.serial), text(frame.identity.firmware), text(frame.identity.sdk),
          text(frame.driver_sha256)};
}

// Number of the last request of any loop: the host answers only another number. 0: no request yet.
std::uint64_t lastRequestOf(const SharedFrame& frame) {
  HostRequest last{};
  return frame.request.take(last) ? last.number : 0;
}

bool sameAxes(const std::vector<wh_axis>& a, const std::vector<wh_axis>& b) {
  return std::equal(a.begin(), a.end(), b.begin(), b.end(), [](const wh_axis& x, const wh_axis& y) {
    return std::strcmp(x.name, y.name) == 0 && x.kind == y.kind &&
           x.effort_meaning == y.effort_meaning && x.lower == y.lower && x.upper == y.upper &&
           x.effort_limit == y.effort_limit && x.resolution == y.resolution &&
           x.delay_s == y.delay_s && x.silence_s == y.silence_s;
  });
}

}  // namespace

HostedDriver::HostedDriver(std::string name, std::unique_ptr<HostSegment> segment)
    : name_(std::move(name)), segment_(std::move(segment)), axes_(axesOf(segment_->frame())) {
  identity_ = identityOf(segment_->frame());
  requests_ = lastRequestOf(segment_->frame());
}

Expected<std::shared_ptr<HostedDriver>> HostedDriver::connect(const std::string& name) {
  auto segment = HostSegment::attach(name);
  if (!segment) return segment.errors();
  return std::shared_ptr<HostedDriver>(new HostedDriver(name, std::move(*segment)));
}

Diagnostic HostedDriver::no(const std::string& problem, const std::string& remedy) const {
  return {"", 0, "host", name_, problem, remedy};
}

std::string HostedDriver::name() const {
  const char(&text)[64] = segment_->frame().driver;
  return {text, ::strnlen(text, sizeof(text))};
}

Diagnostics HostedDriver::differences(const DeviceModel& model) const {
  Diagnostics out;
  const auto compare = [&](std::size_t i, double host, double loop, const char* what) {
    if (std::abs(host - loop) <= 1e-9) return;
    out.push_back(keyFault(model.path, "axes", axes_[i].name,
                           where() + " has another " + what + ": " + std::to_string(host) +
                               ", not " + std::to_string(loop),
                           "give host and loop the same device file"));
  };
  for (std::size_t i = 0; i < axes_.size(); ++i) {
    const int at = model.axisIndex(axes_[i].name);
    const bool ours = at >= 0;
    compare(i, segment_->frame().neutral[i], ours ? model.axes[at].neutral_effort : 0.0,
            "neutral effort");
    compare(i, segment_->frame().limit[i], ours ? model.axes[at].effort_limit : 0.0,
            "effort limit");
  }
  return out;
}

Expected<Done> HostedDriver::connectAnew() {
  auto segment = HostSegment::attach(name_);
  if (!segment) return segment.errors();
  if (!sameAxes(axesOf((*segment)->frame()), axes_)) {
    return no("was started again with other axes", "start this program again, too");
  }
  {
    const std::lock_guard lock(replaces_);
    segment_ = std::move(*segment);
  }
  identity_ = identityOf(segment_->frame());
  requests_ = lastRequestOf(segment_->frame());
  last_ = {};
  return Done{};
}

HostFacts HostedDriver::facts() const {
  std::shared_ptr<HostSegment> segment;
  {
    const std::lock_guard lock(replaces_);
    segment = segment_;
  }
  return factsOf(segment->frame(), name_);
}

Expected<HostAnswer> HostedDriver::ask(std::uint32_t verb, double argument) {
  HostRequest request{++requests_, ::getpid(), verb, argument};
  segment_->frame().request.publish(request);
  HostAnswer answer{};
  const std::int64_t until_ns =
      monotonicNow_ns() + (verb == WH_DISABLE ? kEndWithin_ns : kAnswerWithin_ns);
  while (!segment_->frame().answer.take(answer) || answer.number != request.number) {
    if (!segment_->hostLives()) return no("is gone", "start it with wholehand device-host");
    if (monotonicNow_ns() > until_ns) return no("does not answer", "end it and start it again");
    std::this_thread::sleep_for(kAnswerEvery);
  }
  answer.text[sizeof(answer.text) - 1] = 0;
  return answer;
}

// Waits for samples of the new session. Earlier samples still report that the device is not
// enabled.
Expected<Done> HostedDriver::awaitSession() {
  const std::int64_t until_ns = monotonicNow_ns() + kSampleWithin_ns;
  HostSample sample{};
  while (!segment_->frame().sample.take(sample) || sample.session != session_ ||
         sample.cycle <= last_.cycle + 1) {
    if (monotonicNow_ns() > until_ns) return no("stands still", "end it and start it again");
    std::this_thread::sleep_for(kAnswerEvery);
  }
  last_ = sample;
  return Done{};
}

Expected<Done> HostedDriver::reconnect() {
  if (segment_->hostLives() && !segment_->replaced()) return Done{};
  return connectAnew();
}

Expected<Done> HostedDriver::control(std::uint32_t verb, double argument) {
  if (verb != WH_DISABLE && !segment_->publishesSamples()) {
    return no("stands still", "end it and start it again");
  }
  (void)segment_->frame().sample.take(last_);
  asks_.store(true);
  auto answer = ask(verb, argument);
  asks_.store(false);
  if (verb == WH_DISABLE) in_session_.store(false);
  if (!answer) return answer.errors();
  if (answer->ok != 1) return no(answer->text, "look at the device");
  if (verb == WH_DISABLE) session_ = 0;
  if (verb != WH_ENABLE) return Done{};
  session_ = answer->session;
  in_session_.store(true);
  (void)segment_->frame().sample.take(last_);
  return awaitSession();
}

double HostedDriver::switchesWithin_s() const noexcept {
  constexpr double kRequested_s = 0.03;
  return segment_->frame().switches_within_s + kRequested_s;
}

int HostedDriver::read(wh_sample& sample) noexcept {
  const bool taken = segment_->frame().sample.take(last_);
  sample = last_.sample;
  reason_.store(last_.reason, std::memory_order_relaxed);
  if (last_.read_result < 0) return last_.read_result;
  const bool ours = last_.session == session_ && last_.phase != HostPhase::kIdle;
  if (!ours) sample.status &= ~static_cast<std::uint32_t>(WH_ENABLED);
  if (last_.phase == HostPhase::kRamping || last_.phase == HostPhase::kLatched) {
    sample.status |= WH_SILENCED;
  }
  return taken ? last_.read_result : WH_NOTHING_NEW;
}

int HostedDriver::write(const wh_command& command) noexcept {
  command_.session = session_;
  command_.sequence = command.sequence;
  command_.monotonic_ns = monotonicNow_ns();
  command_.axes = command.axes;
  std::copy(std::begin(command.effort), std::end(command.effort), std::begin(command_.effort));
  segment_->frame().command.publish(command_);
  return last_.session == session_ && last_.write_result < 0 ? last_.write_result : WH_OK;
}

void HostedDriver::probe() noexcept {
  HostCommand probe{};
  probe.session = kNoSession;
  probe.sequence = ++probes_;
  probe.monotonic_ns = monotonicNow_ns();
  segment_->frame().command.publish(probe);
}

WayTimes HostedDriver::way() const noexcept {
  return {last_.monotonic_ns, last_.command, last_.command_sent_ns, last_.command_arrived_ns};
}

}  // namespace wholehand
