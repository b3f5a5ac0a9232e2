#include "server/udp_peer.hpp"

#include <algorithm>

namespace wholehand::udp {

bool Decimator::due(std::uint64_t tick) noexcept {
  if (rate_hz_ == 0 || (any_ && tick == last_)) return false;
  const auto slot = [&](std::uint64_t t) { return t * rate_hz_ / tick_rate_hz_; };
  const bool now = !any_ || tick < last_ || rate_hz_ >= tick_rate_hz_ || slot(tick) != slot(last_);
  any_ = true;
  last_ = tick;
  return now;
}

bool ReliableOutbox::add(Message message) {
  if (waiting_.size() >= kMostWaiting) return false;
  waiting_.push_back({++last_sequence_, std::move(message)});
  return true;
}

void ReliableOutbox::acknowledge(std::uint32_t sequence) {
  const auto it = std::find_if(waiting_.begin(), waiting_.end(),
                               [&](const Waiting& w) { return w.sequence == sequence; });
  if (it != waiting_.end() && it->sent) waiting_.erase(it);
}

void ReliableOutbox::sendDue(std::int64_t now_ns, const Send& send) {
  const std::size_t n = std::min(waiting_.size(), kMostUnderway);
  for (std::size_t i = 0; i < n; ++i) {
    Waiting& w = waiting_[i];
    if (w.sent && now_ns < w.due_ns) continue;
    send(w.sequence, *w.message, w.sent);
    if (w.sent) w.pause_ns = std::min(2 * w.pause_ns, kLongestPause_ns);
    w.sent = true;
    w.due_ns = now_ns + w.pause_ns;
  }
}

}  // namespace wholehand::udp
