#include "telemetry/hub.hpp"

#include "telemetry/recording.hpp"
#include "telemetry/statistics.hpp"

#include <chrono>
#include <cstdio>
#include <exception>

namespace wholehand {

using Clock = std::chrono::steady_clock;

namespace {
constexpr auto kIdle = std::chrono::milliseconds(1);
/// Without ticks (paused, late) the recorder cannot see time pass; the hub flushes it instead.
constexpr auto kFlushAfter = std::chrono::milliseconds(400);
}  // namespace

void TelemetryHub::start() {
  if (thread_.joinable()) return;
  stopping_ = false;
  failures_.reserve(failures_.size() + sinks_.size() + 3);  // recorder, statistics, source
  thread_ = std::thread([this] { run(); });
}

void TelemetryHub::stop() {
  if (!thread_.joinable()) return;
  stopping_ = true;
  thread_.join();
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
bool TelemetryHub::holds(const char* consumer, std::size_t number, Call&& call) noexcept {
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
  if (failures_.size() == failures_.capacity()) return;  // cannot be: each fails once
  Failure& failure = failures_.emplace_back();
  failure.consumer = consumer;
  failure.number = number;
  std::snprintf(failure.why.data(), failure.why.size(), "%s", why);
}

void TelemetryHub::hand(const TickRecord& record) noexcept {
  if (recording_failed_) ++unrecorded_;
  if (writer_ != nullptr) {
    // The writer counts its own drops; the record at which it throws is lost.
    if (!holds("the recorder", 0, [&] { writer_->append(record); })) {
      writer_ = nullptr;
      recording_failed_ = true;
      ++unrecorded_;
    }
  }
  if (statistics_ != nullptr && !holds("the statistics", 0, [&] { statistics_->add(record); })) {
    statistics_ = nullptr;
  }
  for (std::size_t i = 0; i < sinks_.size(); ++i) {
    if (sinks_[i] && !holds("sink", i + 1, [&] { sinks_[i](record); })) sinks_[i] = nullptr;
  }
}

void TelemetryHub::flush() noexcept {
  if (writer_ == nullptr || holds("the recorder", 0, [&] { writer_->flush(); })) return;
  writer_ = nullptr;
  recording_failed_ = true;
}

bool TelemetryHub::drain() noexcept {
  TickRecord record;
  bool any_record = false;
  const auto next = [&] {
    bool more = false;
    if (source_ && !holds("the source", 0, [&] { more = source_(record); })) source_ = nullptr;
    return more;
  };
  while (next()) {
    any_record = true;
    hand(record);
    ++consumed_;
  }
  return any_record;
}

void TelemetryHub::run() noexcept {
  Clock::time_point last_record = Clock::now();
  bool flushed = true;
  while (true) {
    // Read before draining: what was pushed before stop() is then taken for sure.
    const bool last_round = stopping_;
    if (drain()) {
      last_record = Clock::now();
      flushed = false;
    }
    if (last_round) break;
    if (!flushed && Clock::now() - last_record > kFlushAfter) {
      flush();
      flushed = true;
    }
    std::this_thread::sleep_for(kIdle);
  }
  flush();
}

}  // namespace wholehand
