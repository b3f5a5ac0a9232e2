#pragma once

#include "loop/core/tick_record.hpp"
#include "loop/model/device_model.hpp"
#include "loop/runtime/statistics.hpp"

#include <memory>
#include <mutex>
#include <string>

namespace wholehand {

/// A status line of a run: rewritten in place on a terminal, else printed at intervals.
class StatusLine {
 public:
  explicit StatusLine(const DeviceModel& device);

  /// Updates the line; on a terminal at most 5 times a second, else every 5 s of a session.
  void update(const TickSummary& summary, double rate_hz);
  /// Ends the line.
  void finish();

 private:
  [[nodiscard]] std::string text(const TickSummary& summary, double rate_hz) const;

  const DeviceModel& device_;
  bool terminal_;
  bool drawn_ = false;
  double next_wall_s_ = 0.0;
  double next_run_s_ = 0.0, last_run_s_ = 0.0;
};

/// The terminal: the status line from the thread that keeps the loop, and messages of other
/// threads. Any thread.
class Terminal {
 public:
  /// Begins a status line. @pre device outlives end()
  void begin(const DeviceModel& device);
  void end();
  /// Prints a line. Waits at most a second for a reader; then the line is dropped, and the number
  /// of dropped lines is printed before the next one.
  void print(const std::string& text);
  /// Updates the status line. Dropped if the terminal would block: the thread that keeps the loop
  /// never waits for it.
  void update(const TickSummary& now, double rate_hz);

 private:
  std::mutex mutex_;
  int unread_ = 0;  ///< lines dropped since the last printed one
  std::unique_ptr<StatusLine> line_;
};

/// The effort with the largest fraction of its limit, as text: "finger_flexion 7.31 N at the tip".
[[nodiscard]] std::string largestEffort(const DeviceModel& device, const AxisEffort& effort);

}  // namespace wholehand
