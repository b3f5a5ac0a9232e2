#include "telemetry/hub.hpp"

#include "telemetry/recording.hpp"
#include "telemetry/statistics.hpp"

#include <chrono>

namespace wholehand {

using Clock = std::chrono::steady_clock;

namespace {
constexpr auto kIdle = std::chrono::milliseconds(2);
/// Without ticks (paused, late) the recorder cannot see time pass; the hub flushes it instead.
constexpr auto kFlushAfter = std::chrono::milliseconds(400);
}  // namespace

void TelemetryHub::start() {
  if (thread_.joinable()) return;
  stopping_ = false;
  thread_ = std::thread([this] { run(); });
}

void TelemetryHub::stop() {
  if (!thread_.joinable()) return;
  stopping_ = true;
  thread_.join();
}

bool TelemetryHub::drain() {
  TickRecord record;
  bool any_record = false;
  while (source_(record)) {
    any_record = true;
    if (writer_ != nullptr) writer_->append(record);  // counts its drops itself
    if (statistics_ != nullptr) statistics_->add(record);
    for (const Sink& sink : sinks_) sink(record);
    ++consumed_;
  }
  return any_record;
}

void TelemetryHub::run() {
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
      if (writer_ != nullptr) writer_->flush();
      flushed = true;
    }
    std::this_thread::sleep_for(kIdle);
  }
  if (writer_ != nullptr) writer_->flush();
}

}  // namespace wholehand
