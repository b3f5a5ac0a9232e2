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

/// The only consumer of the real-time side's queue. It takes records on its own thread and passes
/// each record to the statistics and the other sinks. The recorder has its own thread and queue. A
/// slow disk delays only that thread; its queue then fills and counts dropped records, while all
/// other consumers get every tick. A sink that throws is not called again and the others continue,
/// so that no exception ends the process and the loop.
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

  // Call these before start(). The hub does not own the consumers.
  void record(RecordingWriter& writer) { writer_ = &writer; }
  void count(TickStatistics& statistics) { statistics_ = &statistics; }
  void add(Sink sink) { sinks_.push_back(std::move(sink)); }

  /// Starts the thread. Idempotent.
  void start();
  /// Drains the source, flushes the recorder and ends the threads; waits for the disk. Idempotent.
  /// @pre the source's producer has ended (otherwise draining continues until the producer pauses)
  void stop();
  /// Number of records that the recorder missed after it threw or while its disk did not respond.
  [[nodiscard]] std::uint64_t unrecorded() const noexcept { return unrecorded_; }
  /// Texts of the exceptions, "sink 2 threw: bad file". Valid after stop().
  [[nodiscard]] std::vector<std::string> failures() const;

 private:
  /// Uses no heap, because it is filled when memory may be exhausted.
  struct Failure {
    const char* consumer = "";
    std::size_t number = 0;
    std::array<char, 120> why{};
  };

  /// Calls a consumer; false when it threw.
  template <class Call>
  bool succeeds(const char* consumer, std::size_t number, Call&& call) noexcept;
  void noteFailure(const char* consumer, std::size_t number, const char* why) noexcept;
  /// Calls `drain` until stop is requested and once more afterwards; calls `idle` once per pause.
  template <class Drain, class Idle>
  static void poll(const std::atomic<bool>& stopping, std::chrono::milliseconds pause,
                   Drain&& drain, Idle&& idle) noexcept;
  void deliver(const TickRecord& record) noexcept;
  void write(const TickRecord& record) noexcept;
  void flush() noexcept;
  void run() noexcept;
  void runRecorder() noexcept;
  /// Processes all queued records. Returns true when there was at least one.
  bool drain() noexcept;
  bool drainToRecorder() noexcept;

  /// Capacity of the recorder's queue: at 1 kHz 13 s of free motion, or 5 s with 10 bodies and 20
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
  std::vector<Failure> failures_;  ///< start() reserves room for one failure of each consumer
};

}  // namespace wholehand
