#pragma once

#include "core/tick_record.hpp"
#include "model/device_model.hpp"
#include "telemetry/statistics.hpp"

#include <memory>
#include <mutex>
#include <string>

namespace wholehand {

/// One line that says how a run goes, rewritten in place on a terminal, printed now and then
/// elsewhere.
class StatusLine {
 public:
  explicit StatusLine(const DeviceModel& device);

  /// Shows the state; on a terminal at most 5 times a second, else every 5 s of a session.
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

/// The one line on the terminal, written by whoever keeps the loop, and what others have to say
/// while it stands there. Any thread.
class Terminal {
 public:
  /// @pre device outlives end()
  void begin(const DeviceModel& device);
  void end();
  void say(const std::string& text);
  /// Left out where the terminal does not take it at once: who keeps the loop waits for no
  /// terminal.
  void update(const TickSummary& now, double rate_hz);

 private:
  std::mutex mutex_;
  std::unique_ptr<StatusLine> line_;
};

/// The effort that uses the largest share of its limit, in words: "finger_flexion 7.31 N at the
/// tip".
[[nodiscard]] std::string largestEffort(const DeviceModel& device, const AxisEffort& effort);

}  // namespace wholehand
