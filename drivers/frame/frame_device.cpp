#include "drivers/frame/frame_device.hpp"

#include <algorithm>
#include <array>
#include <cstring>
#include <limits>
#include <utility>

namespace wholehand {
namespace {

constexpr std::int64_t kMillisecond_ns = 1'000'000;
constexpr std::int64_t kAskAgain_ns = 20 * kMillisecond_ns;
constexpr std::int64_t kHandshake_ns = 2000 * kMillisecond_ns;
constexpr std::int64_t kControl_ns = 1000 * kMillisecond_ns;
constexpr std::int64_t kSample_ns = 20 * kMillisecond_ns;
constexpr std::int64_t kMovement_ns = 60'000 * kMillisecond_ns;
constexpr const char* kLook = "look at its cable and its power, and at --device-at";

wf_frame questionOf(std::uint8_t kind, std::uint8_t axes, std::uint8_t index) {
  wf_frame frame{};
  frame.kind = kind;
  frame.axes = axes;
  frame.index = index;
  return frame;
}

wh_axis axisOf(const wf_axis& reported) {
  wh_axis axis{};
  axis.size = sizeof(axis);
  std::memcpy(axis.name, reported.name, sizeof(axis.name));
  axis.kind = reported.kind;
  axis.effort_meaning = reported.effort_meaning;
  axis.lower = static_cast<double>(reported.lower);
  axis.upper = static_cast<double>(reported.upper);
  axis.effort_limit = static_cast<double>(reported.effort_limit);
  axis.resolution = static_cast<double>(reported.resolution);
  axis.delay_s = static_cast<double>(reported.delay_s);
  axis.silence_s = static_cast<double>(reported.silence_s);
  return axis;
}

}  // namespace

Expected<std::unique_ptr<FrameDevice>> FrameDevice::open(std::unique_ptr<Carrier> carrier,
                                                         std::uint32_t session, const Wait& wait) {
  std::unique_ptr<FrameDevice> device(new FrameDevice(std::move(carrier), session));
  if (Expected<Done> met = device->shakeHands(wait); !met) return met.errors();
  if (Expected<Done> reported = device->askAxes(wait); !reported) return reported.errors();
  wh_sample first{};
  const std::int64_t until_ns = wait() + kHandshake_ns;
  while (device->read(first) < 0) {
    const std::int64_t now_ns = wait();
    device->pump(now_ns);
    if (now_ns > until_ns) return device->silent("gives no sample");
  }
  return device;
}

Diagnostic FrameDevice::silent(const std::string& what) const {
  return fileFault("", gone_.load() ? "the line is gone" : what, kLook);
}

Expected<Done> FrameDevice::shakeHands(const Wait& wait) {
  if (ask(questionOf(WF_HELLO, 0, 0), WF_WELCOME, kHandshake_ns, wait)) {
    name_ = answer_.name;
    serial_ = answer_.serial;
    firmware_ = answer_.firmware;
    return Done{};
  }
  if (other_version_ != 0) {
    return fileFault("",
                     "the device speaks version " + std::to_string(other_version_) +
                         " of the frame, this is " + std::to_string(WF_VERSION),
                     "update one of them");
  }
  if (other_session_ != 0) {
    return fileFault("", "the device renders for another program", "end that one");
  }
  return silent("nobody answers");
}

Expected<Done> FrameDevice::askAxes(const Wait& wait) {
  for (std::size_t i = 0; i < axes_.size(); ++i) {
    const auto index = static_cast<std::uint8_t>(i);
    const auto count = static_cast<std::uint8_t>(axes_.size());
    if (!ask(questionOf(WF_ASK_AXIS, count, index), WF_AXIS, kControl_ns, wait)) {
      return silent("does not say what axis " + std::to_string(i) + " is");
    }
    axes_[i] = axisOf(answer_.axis);
    const wh_axis& axis = axes_[i];
    const std::string which = "axis " + std::to_string(i) + " (" + axis.name + ") ";
    if (axis.kind > WH_ROTATION || axis.effort_meaning > WH_VIBRATION) {
      return fileFault("", which + "is of a kind that device.h does not know", "fix the firmware");
    }
    for (std::size_t k = 0; k < i; ++k) {
      if (std::strcmp(axes_[k].name, axis.name) != 0) continue;
      return fileFault("", which + "has the name of axis " + std::to_string(k), "fix the firmware");
    }
  }
  return Done{};
}

bool FrameDevice::ask(wf_frame question, std::uint8_t answer, std::int64_t within_ns,
                      const Wait& wait) {
  question.session = session_;
  question.sequence = ++questions_;
  awaited_ = answer;
  std::int64_t now_ns = wait();
  const std::int64_t until_ns = now_ns + within_ns;
  std::int64_t again_ns = now_ns;
  for (; awaited_ != 0 && now_ns <= until_ns && !gone_.load(); now_ns = wait()) {
    if (now_ns >= again_ns) {
      sendFrame(question);
      again_ns = now_ns + kAskAgain_ns;
    }
    pump(now_ns);
  }
  return std::exchange(awaited_, std::uint8_t{0}) == 0;
}

Expected<Done> FrameDevice::control(std::uint32_t verb, double argument, const Wait& wait) {
  if (verb > WH_DROP_WATCHDOG) return fileFault("", "there is no such verb", "");
  if (verb == WH_DROP_WATCHDOG) {
    muted_ = true;
    return Done{};
  }
  if (verb == WH_ENABLE) {
    PostedCommand last{};
    if (posts_.take(last)) sent_number_ = last.number;  // earlier commands are not sent
    muted_ = false;
    if (commands_ != 0) commands_ += WF_ENABLE_SKIP;
    begun_at_ = commands_;
  }
  if (verb == WH_DISABLE) enabled_.store(false);
  wf_frame question = questionOf(WF_CONTROL, static_cast<std::uint8_t>(axes_.size()),
                                 static_cast<std::uint8_t>(verb));
  question.argument = static_cast<float>(argument);
  const bool moves = verb == WH_HOME || verb == WH_SELF_TEST;
  if (!ask(question, WF_ANSWER, moves ? kMovement_ns : kControl_ns, wait)) {
    return silent("does not answer");
  }
  if (answer_.result < 0) {
    return keyFault(
        "", "", std::to_string(answer_.result),
        answer_.result == WH_UNSUPPORTED ? "the device cannot do it" : "the device did not do it",
        "look at the device");
  }
  if (verb == WH_ENABLE) {
    awaitEnabledSample(wait);
    enabled_.store(true);
  }
  return Done{};
}

// Waits for a sample after the answer: the previous sample still reports that the device is off.
void FrameDevice::awaitEnabledSample(const Wait& wait) {
  const std::uint64_t before = sample_.sequence;
  const auto is_on = [&] {
    return sample_.sequence != before && (sample_.status & WH_ENABLED) != 0;
  };
  std::int64_t now_ns = wait();
  for (const std::int64_t until_ns = now_ns + kSample_ns; !gone_.load(); now_ns = wait()) {
    pump(now_ns);
    if (is_on() || now_ns >= until_ns) return;
  }
}

FrameCounters FrameDevice::counters() const {
  return {broken_.load(), crc_errors_.load(), foreign_.load(), stale_.load()};
}

void FrameDevice::sendFrame(const wf_frame& frame) noexcept {
  std::array<std::uint8_t, WF_MAX_WIRE> wire{};
  const std::size_t count = wf_encode(&frame, wire.data());
  if (count > 0 && !carrier_->send(wire.data(), count)) gone_.store(true);
}

void FrameDevice::sendCommand(std::int64_t now_ns) noexcept {
  PostedCommand post{};
  if (muted_ || !enabled_.load() || carrier_->waiting() > 0) return;
  if (!posts_.take(post) || post.number == sent_number_) return;
  sent_number_ = post.number;
  wf_frame frame = questionOf(WF_COMMAND, static_cast<std::uint8_t>(axes_.size()), 0);
  frame.session = session_;
  frame.sequence = ++commands_;
  sent_ns_[commands_ % sent_ns_.size()] = now_ns;
  for (std::size_t i = 0; i < axes_.size(); ++i) {
    frame.effort[i] = static_cast<float>(post.command.effort[i]);
  }
  sendFrame(frame);
}

void FrameDevice::pump(std::int64_t now_ns) noexcept {
  std::array<std::uint8_t, 1024> bytes{};
  wf_frame frame{};
  while (!gone_.load()) {
    const int count = carrier_->receive(bytes.data(), bytes.size());
    if (count < 0) gone_.store(true);
    if (count <= 0) break;
    for (int i = 0; i < count; ++i) {
      switch (wf_receive(&receiver_, bytes[static_cast<std::size_t>(i)], &frame)) {
        case WF_GOOD:
          take(frame, now_ns);
          break;
        case WF_OTHER_VERSION:
          if (frame.kind == WF_WELCOME) other_version_ = frame.version;
          foreign_.fetch_add(1);
          break;
        case WF_BROKEN:
          broken_.fetch_add(1);
          break;
        case WF_CRC_ERROR:
          crc_errors_.fetch_add(1);
          break;
        case WF_NONE:
          break;
      }
    }
  }
  if (!gone_.load()) sendCommand(now_ns);
}

void FrameDevice::take(const wf_frame& frame, std::int64_t now_ns) noexcept {
  const bool welcome = frame.kind == WF_WELCOME;
  const bool ours = frame.session == session_ && (welcome || frame.axes == axes_.size());
  if (!ours) {
    if (welcome) other_session_ = frame.session;
    foreign_.fetch_add(1);
    return;
  }
  if (frame.kind == WF_SAMPLE) {
    takeSample(frame, now_ns);
  } else if (frame.kind == awaited_ && frame.sequence == questions_) {
    answer_ = frame;
    awaited_ = 0;
    if (welcome) axes_.resize(frame.axes);  // axes_ has reserved room; samples follow at once
  } else {
    stale_.fetch_add(1);  // a second or late answer
  }
}

std::int64_t FrameDevice::receivedUntil_ns(std::uint32_t heard,
                                           std::int64_t now_ns) const noexcept {
  if (wf_newer(begun_at_, heard)) heard = begun_at_;
  if (!wf_newer(commands_, heard))
    return now_ns;  // heard all commands, or those of an earlier
                    // session
  const std::uint32_t unheard = std::min<std::uint32_t>(commands_ - heard, sent_ns_.size());
  return sent_ns_[(commands_ - unheard + 1) % sent_ns_.size()];
}

void FrameDevice::takeSample(const wf_frame& frame, std::int64_t now_ns) noexcept {
  if (!wf_newer(frame.sequence, last_sample_)) {
    stale_.fetch_add(1);
    return;
  }
  constexpr double kUnknown = std::numeric_limits<double>::quiet_NaN();
  sample_.size = sizeof(sample_);
  sample_.status = frame.status;
  sample_.sequence += frame.sequence - last_sample_;
  sample_.monotonic_ns = std::max(sample_.monotonic_ns, receivedUntil_ns(frame.heard, now_ns));
  sample_.valid = frame.valid;
  sample_.vendor_code = frame.vendor_code;
  for (std::size_t i = 0; i < axes_.size(); ++i) {
    sample_.position[i] = static_cast<double>(frame.position[i]);
    sample_.effort[i] = static_cast<double>(frame.effort[i]);
    sample_.temperature_c[i] = kUnknown;
  }
  last_sample_ = frame.sequence;
  samples_.publish(sample_);
}

int FrameDevice::read(wh_sample& sample) noexcept {
  if (gone_.load(std::memory_order_relaxed)) return WH_FAILED;
  const std::uint64_t before = newest_.sequence;
  (void)samples_.take(newest_);  // if the bus is writing, this is the previous sample
  if (newest_.sequence == 0) return WH_FAILED;
  sample = newest_;
  return newest_.sequence != before ? WH_OK : WH_NOTHING_NEW;
}

int FrameDevice::write(const wh_command& command) noexcept {
  if (gone_.load(std::memory_order_relaxed) || !enabled_.load(std::memory_order_relaxed)) {
    return WH_FAILED;
  }
  if (command.axes != axes_.size()) return WH_FAILED;
  ++post_.number;
  post_.command = command;
  posts_.publish(post_);
  return WH_OK;
}

}  // namespace wholehand
