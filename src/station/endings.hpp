#pragma once

#include "vocabulary/backend.hpp"

#include <chrono>
#include <cstdint>
#include <map>
#include <utility>

namespace wholehand {

/// Counts what ended the rendering: stops, rests, faults, sessions that were over. An order to arm
/// names the last ending that its person saw, so that none can be passed unseen
/// (docs/adr/0016-arming-names-the-last-ending.md). One thread at a time.
class Endings {
 public:
  using Clock = std::chrono::steady_clock;

  [[nodiscard]] std::uint32_t count() const { return count_; }
  /// Accepts only an order that has seen the last ending.
  [[nodiscard]] OrderReply refuseUnseen(std::uint32_t seen) const;
  /// Whether a stop came after the order of that number.
  [[nodiscard]] bool stoppedSince(std::uint64_t asked) const { return stop_asked_ > asked; }
  /// Number of the newest stop among the orders.
  [[nodiscard]] std::uint64_t newestStop() const { return stop_asked_; }
  /// Whether the last ending is a rest.
  [[nodiscard]] bool rested(RunState now) const;
  /// Whether that rest ended nothing: nothing rendered or was being armed.
  [[nodiscard]] bool restBeforeStart() const { return rest_before_start_; }

  /// Takes a stop, an emergency stop or a rest.
  /// @param asked number of the order
  /// @param now before this stop
  /// @param arming an order was about to start the device, until this stop
  void stop(const Order& order, std::uint64_t asked, Clock::time_point at, RunState now,
            bool arming);
  /// What a rest ended, or kept from beginning, does not go on: it rests still.
  void countOn();
  /// @param goes_on a load continues the rendering: no ending that a person must see
  void endSession(bool faulted, bool goes_on);
  /// Somebody asks to arm: a stop after that repeats none of before.
  void forgetPresses() { presses_.clear(); }
  void beginSession();
  /// The session that was to begin never ran.
  /// @param before LoopStatus::rested, of before it was to begin
  /// @param count of then
  void restoreRest(bool before, std::uint32_t count);
  /// Another person has no right to rest on; a rest that ended nothing stays.
  void changePerson();

 private:
  /// A stop without a number that comes so soon after the last one repeats it.
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
  /// The newest stop since somebody asked to arm, by client and kind.
  std::map<std::pair<std::uint32_t, std::size_t>, Press> presses_;
};

}  // namespace wholehand
