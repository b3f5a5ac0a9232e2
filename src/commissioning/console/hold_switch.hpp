#pragma once

#include <cstdint>

namespace wholehand {

/// Whether a button is held at another machine, of which only beats arrive. A press that has ended,
/// by whatever, holds nothing any more, whatever beats of it come late. A press has to last for a
/// moment before it holds: a click moves nothing. Time is an argument [ns, monotonic]; one thread
/// at a time.
class HoldSwitch {
 public:
  static constexpr std::int64_t kSilent_ns = 150'000'000;  ///< ends a press
  static constexpr std::int64_t kClick_ns = 200'000'000;   ///< a press lasts longer

  /// @param claim whose holding of the controls it belongs to (Order::claim): rises
  /// @param press of one claim: rises with every new press
  void beat(std::uint32_t claim, std::uint32_t press, std::int64_t now_ns) noexcept;
  /// Ends the press that holds now. Whoever lost the controls, pressed a stop or let go.
  void end() noexcept { alive_ = false; }
  [[nodiscard]] bool held(std::int64_t now_ns) noexcept;

 private:
  void judge(std::int64_t now_ns) noexcept;

  std::uint32_t claim_ = 0, press_ = 0;  ///< the newest
  std::int64_t began_ns_ = 0, beat_ns_ = 0;
  bool alive_ = false;
};

}  // namespace wholehand
