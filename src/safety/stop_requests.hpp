#pragma once

#include "core/fault.hpp"
#include "core/real_time.hpp"

#include <atomic>
#include <cstdint>

namespace wholehand {

/// Counts stop requests. A request stays pending until a tick or an arming has seen it. Lock-free.
class StopRequests {
 public:
  /// Requests a stop. Any thread, also a signal handler; real-time safe.
  void request() noexcept { stops_.fetch_add(1, std::memory_order_seq_cst); }
  /// Requests an emergency stop. Counts as a stop first, so that a reader never sees an emergency
  /// without a stop.
  void requestEmergency() noexcept {
    request();
    emergencies_.fetch_add(1, std::memory_order_seq_cst);
  }

  /// Before arming: true, once, if a stop was requested that neither a tick nor an arming has seen.
  [[nodiscard]] bool consumeUnseen() noexcept {
    const std::uint32_t now = stops_.load(std::memory_order_seq_cst);
    const bool unseen = seen_ != now;
    seen_ = now;
    return unseen;
  }
  /// Last step of arming: later requests stop the ticks. False, once, if a stop was requested since
  /// consumeUnseen(); then nothing is armed.
  [[nodiscard]] bool arm() noexcept {
    // Reads the emergencies first, so that a new one is not mistaken for an old one.
    const std::uint32_t emergencies = emergencies_.load(std::memory_order_seq_cst);
    if (consumeUnseen()) return false;
    armed_at_ = seen_;
    emergencies_armed_at_ = emergencies;
    return true;
  }
  /// In a tick: kStopRequested and kEmergencyStop if requested since arm(). Real-time safe.
  [[nodiscard]] WHOLEHAND_RT Fault pending() noexcept {
    const bool emergency = emergencies_.load(std::memory_order_seq_cst) != emergencies_armed_at_;
    seen_ = stops_.load(std::memory_order_seq_cst);
    if (emergency) return Fault::kStopRequested | Fault::kEmergencyStop;
    return seen_ != armed_at_ ? Fault::kStopRequested : Fault::kNone;
  }

 private:
  std::atomic<std::uint32_t> stops_{0}, emergencies_{0};
  std::uint32_t seen_ = 0, armed_at_ = 0, emergencies_armed_at_ = 0;  ///< arming, ticking thread
};

}  // namespace wholehand
