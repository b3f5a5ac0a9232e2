#include "record/hub.hpp"

#include "loop/runtime/statistics.hpp"
#include "record/recording.hpp"

#include <chrono>
#include <cstdio>
#include <exception>

namespace wholehand {

using Clock = std::chrono::steady_clock;

namespace {
constexpr auto kPause = std::chrono::milliseconds(1);
// Pause between polls; latency is irrelevant here.
constexpr auto kRecorderPause = std::chrono::milliseconds(5);
/// Flush interval while no ticks arrive (paused or late). Without ticks the recorder does not flush
/// by itself.
constexpr auto kFlushAfter = std::chrono::milliseconds(1000);
}  // namespace

void TelemetryHub::start() {
  if (thread_.joinable()) return;
  stopping_ = recorder_stopping_ = false;
  failures_.reserve(failures_.size() + sinks_.size() + 3);  // plus recorder, statistics and source
  if (writer_ != nullptr) {
    to_recorder_ = std::make_unique<RecordQueue>(kWaiting_bytes);
    recorder_ = std::thread([this] { runRecorder(); });
  }
  thread_ = std::thread([this] { run(); });
}

void TelemetryHub::stop() {
  if (!thread_.joinable()) return;
  stopping_ = true;
  thread_.join();
  recorder_stopping_ = true;
  if (recorder_.joinable()) recorder_.join();
}

std::vector<std::string> TelemetryHub::failures() const {
  std::vector<std::string> sentences;
  for (const Failure& f : failures_) {
    std::string who = f.consumer;
    if (f.number > 0) who += " " + std::to_string(f.number);
    sentences.push_back(who + " threw: " + f.why.data());
  }
  return sentences;
}

template <class Call>
bool TelemetryHub::succeeds(const char* consumer, std::size_t number, Call&& call) noexcept {
  try {
    call();
    return true;
  } catch (const std::exception& e) {
    noteFailure(consumer, number, e.what());
  } catch (...) {
    noteFailure(consumer, number, "something that is no std::exception");
  }
  return false;
}

void TelemetryHub::noteFailure(const char* consumer, std::size_t number, const char* why) noexcept {
  const std::lock_guard lock(failures_mutex_);
  if (failures_.size() == failures_.capacity())
    return;  // cannot happen, because each consumer fails once only
  Failure& failure = failures_.emplace_back();
  failure.consumer = consumer;
  failure.number = number;
  std::snprintf(failure.why.data(), failure.why.size(), "%s", why);
}

void TelemetryHub::deliver(const TickRecord& record) noexcept {
  if (to_recorder_ && !to_recorder_->try_push(record)) ++unrecorded_;
  if (statistics_ != nullptr && !succeeds("the statistics", 0, [&] { statistics_->add(record); })) {
    statistics_ = nullptr;
  }
  for (std::size_t i = 0; i < sinks_.size(); ++i) {
    if (sinks_[i] && !succeeds("sink", i + 1, [&] { sinks_[i](record); })) sinks_[i] = nullptr;
  }
}

void TelemetryHub::write(const TickRecord& record) noexcept {
  // The writer counts its own dropped records. The record during which it throws is lost.
  if (writer_ != nullptr && succeeds("the recorder", 0, [&] { writer_->append(record); })) return;
  writer_ = nullptr;
  ++unrecorded_;
}

void TelemetryHub::flush() noexcept {
  if (writer_ == nullptr || succeeds("the recorder", 0, [&] { writer_->flush(); })) return;
  writer_ = nullptr;
}

bool TelemetryHub::drain() noexcept {
  TickRecord record;
  bool any_record = false;
  const auto next = [&] {
    bool more = false;
    if (source_ && !succeeds("the source", 0, [&] { more = source_(record); })) source_ = nullptr;
    return more;
  };
  while (next()) {
    any_record = true;
    deliver(record);
  }
  return any_record;
}

bool TelemetryHub::drainToRecorder() noexcept {
  TickRecord record;
  bool any_record = false;
  while (to_recorder_->try_pop(record)) {
    any_record = true;
    write(record);
  }
  return any_record;
}

template <class Drain, class Idle>
void TelemetryHub::poll(const std::atomic<bool>& stopping, std::chrono::milliseconds pause,
                        Drain&& drain, Idle&& idle) noexcept {
  Clock::time_point last_record = Clock::now();
  bool paused = true;
  while (true) {
    // `stopping` is read before draining, so that no record pushed before stop() is missed.
    const bool last_round = stopping;
    if (drain()) {
      last_record = Clock::now();
      paused = false;
    }
    if (last_round) return;
    if (!paused && Clock::now() - last_record > kFlushAfter) {
      idle();
      paused = true;
    }
    std::this_thread::sleep_for(pause);
  }
}

void TelemetryHub::run() noexcept {
  poll(
      stopping_, kPause, [this] { return drain(); }, [] {});
}

void TelemetryHub::runRecorder() noexcept {
  poll(
      recorder_stopping_, kRecorderPause, [this] { return drainToRecorder(); },
      [this] { flush(); });
  flush();
}

}  // namespace wholehand
