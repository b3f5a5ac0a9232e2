#pragma once

#include <cstdint>

namespace wholehand {

/// Dead-man switch: whether a button is held on another machine that sends periodic beats. A press
/// that has ended, for any reason, no longer holds, even if late beats of it arrive. A press must
/// last a moment before it counts, so that a click moves nothing. Time is an argument [ns,
/// monotonic]; one thread at a time.
class HoldSwitch {
 public:
  static constexpr std::int64_t kSilent_ns = 120'000'000;  ///< timeout of a press
  static constexpr std::int64_t kClick_ns = 200'000'000;   ///< shorter presses are clicks

  /// @param claim number of the holder's claim to the controls (Order::claim); increases
  /// @param press number of the press within one claim; increases
  void beat(std::uint32_t claim, std::uint32_t press, std::int64_t now_ns) noexcept;
  /// Ends the current press: controls lost, stop pressed or button released.
  void end() noexcept { alive_ = false; }
  [[nodiscard]] bool held(std::int64_t now_ns) noexcept;

 private:
  void judge(std::int64_t now_ns) noexcept;

  std::uint32_t claim_ = 0, press_ = 0;  ///< newest claim and press
  std::int64_t began_ns_ = 0, beat_ns_ = 0;
  bool alive_ = false;
};

}  // namespace wholehand
