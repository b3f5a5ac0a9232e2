#include "commissioning/console/hold_switch.hpp"

#include <tuple>

namespace wholehand {

void HoldSwitch::beat(std::uint32_t claim, std::uint32_t press, std::int64_t now_ns) noexcept {
  const auto newest = std::tie(claim_, press_);
  const auto this_one = std::tie(claim, press);
  if (this_one < newest) return;
  judge(now_ns);
  if (newest < this_one) {
    std::tie(claim_, press_) = this_one;
    began_ns_ = now_ns;
    alive_ = true;
  }
  if (alive_) beat_ns_ = now_ns;
}

// A timeout is final: later beats belong to a press that has ended.
void HoldSwitch::judge(std::int64_t now_ns) noexcept {
  if (now_ns - beat_ns_ > kSilent_ns) alive_ = false;
}

bool HoldSwitch::held(std::int64_t now_ns) noexcept {
  judge(now_ns);
  return alive_ && beat_ns_ - began_ns_ >= kClick_ns;
}

}  // namespace wholehand
