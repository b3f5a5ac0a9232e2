#pragma once

#include "loop/runtime/start_permit.hpp"
#include "vocabulary/backend.hpp"

#include <atomic>
#include <chrono>
#include <cstdint>
#include <functional>

namespace wholehand {

/// Permit of a press of Start or of a load that goes on: it holds while the client that pressed is
/// connected and heard, keeps the controls that it had, and pressed for the person, hand, level and
/// limits in force. It holds for 30 s at most. judge() runs in the loop; it reads only atomics and
/// the clock.
class PressPermit final : public StartPermit {
 public:
  using Clock = std::chrono::steady_clock;
  using Now = std::function<Clock::time_point()>;
  /// Newest message of the client at the instant that the effort may begin.
  static constexpr std::chrono::milliseconds kHeardWithin{200};
  /// Longest time from the press to that instant.
  static constexpr std::chrono::seconds kLongest{30};

  enum class Verdict : std::uint8_t { kOpen, kBegun, kVoid };

  /// @param order with its requester @param newest_claim newest claim on the controls
  /// @param now does not throw
  PressPermit(Order order, Clock::time_point asked_at, Now now,
              const std::atomic<std::uint32_t>& newest_claim)
      : order_(std::move(order)),
        asked_at_(asked_at),
        now_(std::move(now)),
        newest_claim_(newest_claim) {}

  [[nodiscard]] WHOLEHAND_RT bool judge() noexcept override;
  /// Result of judge(), and its reply. Any thread.
  [[nodiscard]] Verdict verdict() const noexcept { return verdict_.load(); }
  [[nodiscard]] OrderReply refusal() const { return replyFor(void_.load()); }
  /// Notes that a client raised a limit after the permit was last judged. Any thread.
  void noteRaisedLimit(std::uint32_t client) noexcept {
    if (client != order_.client) limit_raised_ = true;
  }

  /// Refuses an order whose client is gone or has lost the controls since it asked.
  [[nodiscard]] static OrderReply refuseAbsent(const Order& order, std::uint32_t newest_claim);
  /// Refuses an order that would not get its permit now.
  [[nodiscard]] static OrderReply refuse(const Order& order, Clock::time_point asked_at,
                                         Clock::time_point now, std::uint32_t newest_claim);
  /// Refuses an order that asked too long ago.
  [[nodiscard]] static OrderReply refuseLate(Clock::duration since);

 private:
  enum class Flaw : std::uint8_t { kNone, kGone, kLostControls, kUnheard, kLate, kLimitRaised };
  [[nodiscard]] static Flaw absence(const Order& order, std::uint32_t newest_claim) noexcept;
  [[nodiscard]] static Flaw flaw(const Order& order, Clock::time_point asked_at,
                                 Clock::time_point now, std::uint32_t newest_claim) noexcept;
  [[nodiscard]] static OrderReply replyFor(Flaw flaw);

  const Order order_;
  const Clock::time_point asked_at_;
  const Now now_;
  const std::atomic<std::uint32_t>& newest_claim_;
  std::atomic<bool> limit_raised_{false};
  std::atomic<Flaw> void_{Flaw::kNone};
  std::atomic<Verdict> verdict_{Verdict::kOpen};
};

}  // namespace wholehand
