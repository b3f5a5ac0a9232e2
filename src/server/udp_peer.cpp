#include "server/udp_peer.hpp"

namespace wholehand::udp {

bool Decimator::due(std::uint64_t tick) noexcept {
  if (rate_hz_ == 0 || (any_ && tick == last_)) return false;
  const auto slot = [&](std::uint64_t t) { return t * rate_hz_ / tick_rate_hz_; };
  const bool now = !any_ || tick < last_ || rate_hz_ >= tick_rate_hz_ || slot(tick) != slot(last_);
  any_ = true;
  last_ = tick;
  return now;
}

}  // namespace wholehand::udp
