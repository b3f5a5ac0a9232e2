#pragma once

#include "core/fault.hpp"
#include "core/real_time.hpp"

#include <atomic>
#include <cstdint>

namespace wholehand {

/// Counts the stops that were requested. A request stays pending until a tick or an arming has seen
/// it. Lock-free.
class StopRequests {
 public:
  /// Any thread, also a signal handler; real-time safe.
  void ask() noexcept { stops_.fetch_add(1, std::memory_order_seq_cst); }
  /// The same, as an emergency stop. It counts as a stop first, so that none is seen without one.
  void askInEmergency() noexcept {
    ask();
    emergencies_.fetch_add(1, std::memory_order_seq_cst);
  }

  /// Before arming: true, once, where a stop was asked for that neither a tick nor an arming has
  /// seen.
  [[nodiscard]] bool takeUnseen() noexcept {
    const std::uint32_t now = stops_.load(std::memory_order_seq_cst);
    const bool unseen = seen_ != now;
    seen_ = now;
    return unseen;
  }
  /// The last of arming: what is asked for from here on stops the ticks. False, once, where a stop
  /// was asked for since takeUnseen(); then nothing is armed.
  [[nodiscard]] bool arm() noexcept {
    // The emergencies first, so that none is taken for an old one.
    const std::uint32_t emergencies = emergencies_.load(std::memory_order_seq_cst);
    if (takeUnseen()) return false;
    armed_at_ = seen_;
    emergencies_armed_at_ = emergencies;
    return true;
  }
  /// In a tick: kStopRequested and kEmergencyStop, where they were asked for since arm(). Real-time
  /// safe.
  [[nodiscard]] WHOLEHAND_RT Fault asked() noexcept {
    const bool emergency = emergencies_.load(std::memory_order_seq_cst) != emergencies_armed_at_;
    seen_ = stops_.load(std::memory_order_seq_cst);
    if (emergency) return Fault::kStopRequested | Fault::kEmergencyStop;
    return seen_ != armed_at_ ? Fault::kStopRequested : Fault::kNone;
  }

 private:
  std::atomic<std::uint32_t> stops_{0}, emergencies_{0};
  std::uint32_t seen_ = 0, armed_at_ = 0, emergencies_armed_at_ = 0;  ///< of who arms and ticks
};

}  // namespace wholehand
