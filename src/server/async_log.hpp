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

/// Writes lines on a thread of its own: a terminal that stands still (Ctrl-S) or a full pipe holds
/// up nobody who logs, least of all a thread that an emergency stop goes through. What finds no
/// room is counted and told later. Any thread; not for the tick.
class AsyncLog {
 public:
  using Sink = std::function<void(const std::string&)>;
  static constexpr std::size_t kMostWaiting = 256;

  /// @param sink called by one thread at a time; null: nothing is written
  explicit AsyncLog(Sink sink);
  /// Writes what waits: waits itself where the sink does.
  ~AsyncLog();
  AsyncLog(const AsyncLog&) = delete;
  AsyncLog& operator=(const AsyncLog&) = delete;

  /// Never waits for the sink.
  void write(std::string line);
  /// Waits until all is written, or the time is over.
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
  std::thread thread_;  ///< last: uses all others
};

}  // namespace wholehand
