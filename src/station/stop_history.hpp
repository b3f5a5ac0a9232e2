#pragma once

#include "vocabulary/backend.hpp"

#include <chrono>
#include <cstdint>
#include <map>
#include <utility>

namespace wholehand {

/// Counts the endings of the rendering: stops, rests, faults and finished sessions. An order to arm
/// names the last ending that its sender saw, so that no ending can be overlooked
/// (docs/adr/0016-arm-order-names-the-last-stop.md). One thread at a time.
class StopHistory {
 public:
  using Clock = std::chrono::steady_clock;

  [[nodiscard]] std::uint32_t count() const { return count_; }
  /// Refuses an order to arm whose sender has not seen the last ending.
  /// @param seen Arm.endings_seen
  [[nodiscard]] OrderReply refuseUnacknowledged(std::uint32_t seen) const;
  /// True when a stop arrived after the order with the number `asked`.
  [[nodiscard]] bool stoppedSince(std::uint64_t asked) const { return stop_asked_ > asked; }
  /// Order number of the newest stop.
  [[nodiscard]] std::uint64_t newestStop() const { return stop_asked_; }
  /// True when the last ending is a rest and the loop is stopping or stopped.
  [[nodiscard]] bool rested(RunState now) const;
  /// True when the last rest ended nothing: no session rendered, and none was being armed.
  [[nodiscard]] bool restBeforeStart() const { return rest_before_start_; }

  /// Records a stop, an emergency stop or a rest.
  /// @param asked number of the order
  /// @param now run state before this stop
  /// @param arming an order was about to start the device when this stop arrived
  void stop(const Order& order, std::uint64_t asked, Clock::time_point at, RunState now,
            bool arming);
  /// Counts an ending without a new order: a session that a rest ended or prevented was not
  /// resumed. A rest stays a rest.
  void keepRestPending();
  /// Counts the end of a session.
  /// @param goes_on the rendering continues with another session, so nobody has to see this ending
  void endSession(bool faulted, bool goes_on);
  /// Forgets earlier presses when an order to arm arrives: a later stop is not a repetition of an
  /// earlier one.
  void forgetPresses() { presses_.clear(); }
  void beginSession();
  /// Restores the rest after a session that failed to start.
  /// @param before LoopStatus::rested before the attempt
  /// @param count number of endings before the attempt
  void restoreRest(bool before, std::uint32_t count);
  /// Cancels the rest when another person is loaded, so that this person cannot resume it. A rest
  /// that ended nothing stays.
  void changePerson();

 private:
  /// Two stops without order numbers within this time count as one.
  static constexpr std::chrono::seconds kRepeats{1};
  struct Press {
    std::uint32_t id = 0;  ///< Order::id
    Clock::time_point at;
  };
  bool repeats(const Order& order, Clock::time_point at);

  std::uint32_t count_ = 1;
  std::uint64_t stop_asked_ = 0;
  std::uint32_t rest_ = 0;  ///< ending of the newest rest; 0: none since the last arming
  bool rest_before_start_ = false;
  /// Newest stop since the last order to arm, by client and kind of stop.
  std::map<std::pair<std::uint32_t, std::size_t>, Press> presses_;
};

}  // namespace wholehand
