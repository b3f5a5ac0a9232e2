#pragma once

#include <chrono>
#include <condition_variable>
#include <cstdint>
#include <deque>
#include <functional>
#include <mutex>
#include <string>
#include <thread>

namespace wholehand {

/// Writes log lines on its own thread, so that a stopped terminal (Ctrl-S) or a full pipe never
/// blocks the caller. Emergency stops pass through such callers. Lines that do not fit into the
/// queue are dropped, and their number is logged later. Any thread; not for the tick.
class AsyncLog {
 public:
  using Sink = std::function<void(const std::string&)>;
  static constexpr std::size_t kMostWaiting = 256;

  /// @param sink called by one thread at a time; null: nothing is written
  explicit AsyncLog(Sink sink);
  /// Writes the queued lines. Blocks while the sink blocks.
  ~AsyncLog();
  AsyncLog(const AsyncLog&) = delete;
  AsyncLog& operator=(const AsyncLog&) = delete;

  /// Never waits for the sink.
  void write(std::string line);
  /// Waits until every line is written, or until `within` has passed.
  void flush(std::chrono::milliseconds within);

 private:
  void run();
  void deliver(const std::string& line) noexcept;

  const Sink sink_;
  std::mutex mutex_;
  std::condition_variable changed_;
  std::deque<std::string> waiting_;
  std::uint64_t left_out_ = 0;
  bool writing_ = false, closing_ = false;
  std::thread thread_;  ///< last member: it uses all the others
};

/// Log that a hostile client cannot flood: kBurst lines at once, kPerSecond in the long run.
/// Suppressed lines are counted and reported. One thread.
class RateLimitedLog {
 public:
  static constexpr double kBurst = 20.0, kPerSecond = 2.0;

  explicit RateLimitedLog(std::function<void(const std::string&)> sink) : sink_(std::move(sink)) {}

  void write(const std::string& line, std::int64_t now_ns);

 private:
  std::function<void(const std::string&)> sink_;
  double allowance_ = kBurst;
  std::int64_t last_ns_ = 0;
  std::uint64_t left_out_ = 0;
};

}  // namespace wholehand
