#pragma once

#include "core/fault.hpp"
#include "core/real_time.hpp"

#include <atomic>
#include <cstdint>

namespace wholehand {

/// Counts stop requests. A request stays pending until a tick or an arming has seen it. Lock-free.
class StopRequests {
 public:
  /// Requests a gentle stop. Any thread, also a signal handler; real-time safe.
  void requestGentle() noexcept { stops_.fetch_add(1, std::memory_order_seq_cst); }
  /// Requests a plain stop, which counts as such first: a reader never takes it for a gentle one.
  void request() noexcept {
    plain_.fetch_add(1, std::memory_order_seq_cst);
    requestGentle();
  }
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
    // Reads the kinds first, so that a new stop is not mistaken for an old one.
    const std::uint32_t emergencies = emergencies_.load(std::memory_order_seq_cst);
    const std::uint32_t plain = plain_.load(std::memory_order_seq_cst);
    if (consumeUnseen()) return false;
    armed_at_ = seen_;
    plain_armed_at_ = plain;
    emergencies_armed_at_ = emergencies;
    return true;
  }
  /// In a tick: kStopRequested if a stop was requested since arm(), with kEmergencyStop after an
  /// emergency stop and kGentleStop while only gentle ones were. Real-time safe.
  [[nodiscard]] WHOLEHAND_RT Fault pending() noexcept {
    const bool emergency = emergencies_.load(std::memory_order_seq_cst) != emergencies_armed_at_;
    seen_ = stops_.load(std::memory_order_seq_cst);
    if (emergency) return Fault::kStopRequested | Fault::kEmergencyStop;
    if (plain_.load(std::memory_order_seq_cst) != plain_armed_at_) return Fault::kStopRequested;
    return seen_ != armed_at_ ? Fault::kStopRequested | Fault::kGentleStop : Fault::kNone;
  }

 private:
  std::atomic<std::uint32_t> stops_{0}, plain_{0}, emergencies_{0};
  std::uint32_t seen_ = 0;  ///< as the three below: arming and ticking thread
  std::uint32_t armed_at_ = 0, plain_armed_at_ = 0, emergencies_armed_at_ = 0;
};

}  // namespace wholehand
