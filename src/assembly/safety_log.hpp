#pragma once

#include "core/tick_record.hpp"
#include "model/device_model.hpp"

#include <cstdint>
#include <functional>
#include <mutex>
#include <string>
#include <vector>

namespace wholehand {

/// The supervisor went from one state to the next.
struct SafetyTransition {
  std::uint64_t tick = 0;
  double time_s = 0.0;
  SafetyState from = SafetyState::kDisarmed, to = SafetyState::kDisarmed;
  Fault faults = Fault::kNone;  ///< that stopped rendering; of a stop: who asked
  int axis = -1;                ///< that a limit was exceeded on; -1: none
  double value = 0.0;           ///< what exceeded it, in `unit`
  double limit = 0.0;           ///< 0: none is known
  std::string unit;
  std::string cause;  ///< in words
};

/// "   1.250 s  rendering -> faulted: speed limit exceeded on x, 1.72 m/s of 1.5"
[[nodiscard]] std::string describe(const SafetyTransition& transition);

/// Reads the transitions of the safety supervisor, with their time and cause, off the stream of
/// records: a run on the simulated clock tells them as well. Records in order, from one thread at a
/// time; the rest from any. Locks: not for the tick.
class SafetyLog {
 public:
  /// @param told of every transition, in the thread that adds; may be null
  SafetyLog(DeviceModel device, double period_s,
            std::function<void(const SafetyTransition&)> told = nullptr);

  /// A tick that is not after the last one begins a session: what the last one went through is
  /// forgotten, but not in which state it ended.
  void add(const TickRecord& record);

  [[nodiscard]] SafetyState state() const;
  /// Of the session.
  [[nodiscard]] std::vector<SafetyTransition> transitions() const;
  /// The one to kFaulted, with `to` kDisarmed where there was none in this session.
  [[nodiscard]] SafetyTransition fault() const;

 private:
  [[nodiscard]] SafetyTransition transitionAt(const TickRecord& record) const;
  void nameFault(const TickRecord& record, SafetyTransition& out) const;
  void measure(const TickRecord& record, SafetyTransition& out) const;

  const DeviceModel device_;
  const double period_s_;
  const std::function<void(const SafetyTransition&)> told_;

  void beginSession();

  // Of the thread that adds.
  bool known_ = false;  ///< there was a record before, of the same session
  std::uint64_t last_tick_ = 0;
  AxisPosition last_q_m_;
  double stop_asked_s_ = -1.0;

  mutable std::mutex mutex_;
  SafetyState state_ = SafetyState::kDisarmed;
  std::vector<SafetyTransition> transitions_;
};

}  // namespace wholehand
