#pragma once

#include "loop/core/tick_record.hpp"
#include "loop/model/device_model.hpp"

#include <cstdint>
#include <functional>
#include <mutex>
#include <string>
#include <vector>

namespace wholehand {

/// A state transition of the safety supervisor.
struct SafetyTransition {
  std::uint64_t tick = 0;
  double time_s = 0.0;
  SafetyState from = SafetyState::kDisarmed, to = SafetyState::kDisarmed;
  Fault faults = Fault::kNone;  ///< faults that stopped rendering; for a stop, its source
  int axis = -1;                ///< axis that exceeded a limit; -1: none
  double value = 0.0;           ///< value that exceeded the limit, in `unit`
  double limit = 0.0;           ///< 0: unknown
  std::string unit;
  std::string cause;  ///< cause in words
};

/// "   1.250 s  rendering -> faulted: speed limit exceeded on x, 1.72 m/s of 1.5"
[[nodiscard]] std::string describe(const SafetyTransition& transition);

/// Extracts the transitions of the safety supervisor with time and cause from the stream of
/// records, on any clock. Records are added in order by one thread at a time; other functions may
/// be called from any thread. Uses locks; not real-time safe.
class SafetyLog {
 public:
  /// @param on_transition called for every transition in the thread that adds records; may be null
  SafetyLog(DeviceModel device, double period_s,
            std::function<void(const SafetyTransition&)> on_transition = nullptr);

  /// Adds a record. A tick number that does not increase begins a new session, which clears the
  /// list but keeps the last state.
  void add(const TickRecord& record);

  [[nodiscard]] SafetyState state() const;
  /// Transitions of the session.
  [[nodiscard]] std::vector<SafetyTransition> transitions() const;
  /// The transition to kFaulted; `to` is kDisarmed if the session had none.
  [[nodiscard]] SafetyTransition fault() const;

 private:
  [[nodiscard]] SafetyTransition transitionAt(const TickRecord& record) const;
  void nameFault(const TickRecord& record, SafetyTransition& out) const;
  void measure(const TickRecord& record, SafetyTransition& out) const;

  const DeviceModel device_;
  const double period_s_;
  const std::function<void(const SafetyTransition&)> on_transition_;

  void beginSession();

  // Used only by the thread that adds records.
  bool known_ = false;  ///< a record of this session was added
  std::uint64_t last_tick_ = 0;
  AxisPosition last_q_m_;
  double stop_asked_s_ = -1.0;

  mutable std::mutex mutex_;
  SafetyState state_ = SafetyState::kDisarmed;
  std::vector<SafetyTransition> transitions_;
};

}  // namespace wholehand
