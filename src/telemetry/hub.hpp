#pragma once

#include "core/tick_record.hpp"
#include "realtime/spsc_queue.hpp"

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

/// The only consumer of the real-time side's records: takes them from their queue on a thread of
/// its own, and hands each to the statistics and any other sink. The recorder has a thread and a
/// queue of its own: a slow disk slows that thread alone, its queue then fills, drops and counts,
/// and everybody else is told of every tick. A consumer that throws is asked no more, the others go
/// on: what happens here never ends the process, and with it the loop.
///
/// The recorder, the statistics and the sinks must outlive the hub.
class TelemetryHub {
 public:
  /// Takes the next record; false when there is none at present. Called from the hub's thread only.
  using Source = std::function<bool(TickRecord&)>;
  using Sink = std::function<void(const TickRecord&)>;

  explicit TelemetryHub(Source source) : source_(std::move(source)) {}
  ~TelemetryHub() { stop(); }
  TelemetryHub(const TelemetryHub&) = delete;
  TelemetryHub& operator=(const TelemetryHub&) = delete;

  // Before start() only. Neither is owned.
  void record(RecordingWriter& writer) { writer_ = &writer; }
  void count(TickStatistics& statistics) { statistics_ = &statistics; }
  void add(Sink sink) { sinks_.push_back(std::move(sink)); }

  /// Starts the thread. Idempotent.
  void start();
  /// Takes what the source still holds, flushes the recorder, ends the threads: waits for the disk.
  /// Idempotent.
  /// @pre the source's producer has ended (else the drain follows it until it pauses).
  void stop();
  [[nodiscard]] std::uint64_t consumed() const noexcept { return consumed_; }
  /// Records that the recorder did not get: since it threw, and while its disk stood still.
  [[nodiscard]] std::uint64_t unrecorded() const noexcept { return unrecorded_; }
  /// What threw, in words: "sink 2 threw: bad file". Valid after stop().
  [[nodiscard]] std::vector<std::string> failures() const;

 private:
  /// Without heap: it is filled in where memory may have run out.
  struct Failure {
    const char* consumer = "";
    std::size_t number = 0;
    std::array<char, 120> why{};
  };

  /// Calls a consumer; false where it threw.
  template <class Call>
  bool holds(const char* consumer, std::size_t number, Call&& call) noexcept;
  void noteFailure(const char* consumer, std::size_t number, const char* why) noexcept;
  /// Calls `drain` until it was told to stop before the last call, and `idle` once after every
  /// pause.
  template <class Drain, class Idle>
  static void follow(const std::atomic<bool>& stopping, std::chrono::milliseconds pause,
                     Drain&& drain, Idle&& idle) noexcept;
  void hand(const TickRecord& record) noexcept;
  void write(const TickRecord& record) noexcept;
  void flush() noexcept;
  void run() noexcept;
  void runRecorder() noexcept;
  /// Takes all records that wait; true when there was one.
  bool drain() noexcept;
  bool drainToRecorder() noexcept;

  /// Ticks that wait for the disk; four seconds at 1 kHz.
  static constexpr std::size_t kWaitingTicks = 4096;

  Source source_;
  RecordingWriter* writer_ = nullptr;
  std::unique_ptr<SpscQueue<TickRecord>> to_recorder_;  ///< where there is one
  TickStatistics* statistics_ = nullptr;
  std::vector<Sink> sinks_;
  std::thread thread_, recorder_;
  std::atomic<bool> stopping_{false}, recorder_stopping_{false};
  std::atomic<std::uint64_t> consumed_{0}, unrecorded_{0};
  std::mutex failures_mutex_;
  std::vector<Failure> failures_;  ///< room for one of each is reserved by start()
};

}  // namespace wholehand
