#pragma once

#include "loop/core/tick_record.hpp"
#include "loop/realtime/spsc_queue.hpp"

#include <array>
#include <atomic>
#include <chrono>
#include <cstdint>
#include <functional>
#include <memory>
#include <mutex>
#include <string>
#include <thread>
#include <vector>

namespace wholehand {

class RecordingWriter;
class TickStatistics;

/// The only consumer of the real-time side's queue. Takes records on its own thread and passes each
/// to the statistics and the other sinks. The recorder has its own thread and queue: a slow disk
/// delays only that thread, whose queue then fills, drops and counts, while all others get every
/// tick. A sink that throws is not called again and the others continue: no exception here ends the
/// process, and with it the loop.
///
/// The recorder, the statistics and the sinks must outlive the hub.
class TelemetryHub {
 public:
  /// Takes the next record; false when there is none. Called on the hub's thread only.
  using Source = std::function<bool(TickRecord&)>;
  using Sink = std::function<void(const TickRecord&)>;

  explicit TelemetryHub(Source source) : source_(std::move(source)) {}
  ~TelemetryHub() { stop(); }
  TelemetryHub(const TelemetryHub&) = delete;
  TelemetryHub& operator=(const TelemetryHub&) = delete;

  // Before start() only. The hub owns none of them.
  void record(RecordingWriter& writer) { writer_ = &writer; }
  void count(TickStatistics& statistics) { statistics_ = &statistics; }
  void add(Sink sink) { sinks_.push_back(std::move(sink)); }

  /// Starts the thread. Idempotent.
  void start();
  /// Drains the source, flushes the recorder and ends the threads; waits for the disk. Idempotent.
  /// @pre the source's producer has ended (else the drain continues until it pauses)
  void stop();
  /// Records that the recorder missed: after it threw, or while its disk did not respond.
  [[nodiscard]] std::uint64_t unrecorded() const noexcept { return unrecorded_; }
  /// Exceptions as text: "sink 2 threw: bad file". Valid after stop().
  [[nodiscard]] std::vector<std::string> failures() const;

 private:
  /// Uses no heap: it is filled when memory may be exhausted.
  struct Failure {
    const char* consumer = "";
    std::size_t number = 0;
    std::array<char, 120> why{};
  };

  /// Calls a consumer; false when it threw.
  template <class Call>
  bool succeeds(const char* consumer, std::size_t number, Call&& call) noexcept;
  void noteFailure(const char* consumer, std::size_t number, const char* why) noexcept;
  /// Calls `drain` until stop is requested, and once more after that; calls `idle` once per pause.
  template <class Drain, class Idle>
  static void poll(const std::atomic<bool>& stopping, std::chrono::milliseconds pause,
                   Drain&& drain, Idle&& idle) noexcept;
  void deliver(const TickRecord& record) noexcept;
  void write(const TickRecord& record) noexcept;
  void flush() noexcept;
  void run() noexcept;
  void runRecorder() noexcept;
  /// Processes all queued records; true when there was one.
  bool drain() noexcept;
  bool drainToRecorder() noexcept;

  /// Queue capacity towards the disk: at 1 kHz 13 s of free motion, 5 s with 10 bodies and 20
  /// contacts.
  static constexpr std::size_t kWaiting_bytes = std::size_t{24} << 20U;

  Source source_;
  RecordingWriter* writer_ = nullptr;
  std::unique_ptr<RecordQueue> to_recorder_;  ///< null without a recorder
  TickStatistics* statistics_ = nullptr;
  std::vector<Sink> sinks_;
  std::thread thread_, recorder_;
  std::atomic<bool> stopping_{false}, recorder_stopping_{false};
  std::atomic<std::uint64_t> unrecorded_{0};
  std::mutex failures_mutex_;
  std::vector<Failure> failures_;  ///< start() reserves room for one of each
};

}  // namespace wholehand
