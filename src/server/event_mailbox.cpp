#include "server/event_mailbox.hpp"

#include <algorithm>

namespace wholehand {

void EventMailbox::put(const TickRecord& record, std::int64_t now_ns) {
  const std::lock_guard lock(mutex_);
  newest_ns_ = now_ns;
  arrivals_[record.tick % arrivals_.size()] = {record.tick, now_ns};
  const int n = std::clamp(record.exercise.event_count, 0, kMaxExerciseEvents);
  for (int i = 0; i < n; ++i) {
    if (waiting_.size() == kCapacity) {
      ++dropped_;
    } else {
      waiting_.push_back({record.tick, record.exercise.events[i]});
    }
  }
}

void EventMailbox::fetch(std::vector<wire::NumberedEvent>& events) {
  events.clear();
  const std::lock_guard lock(mutex_);
  events.assign(waiting_.begin(), waiting_.end());
  waiting_.clear();
}

std::int64_t EventMailbox::arrivalOf(std::uint64_t tick) const {
  const std::lock_guard lock(mutex_);
  const Arrival& a = arrivals_[tick % arrivals_.size()];
  return a.tick == tick ? a.at_ns : newest_ns_;
}

std::int64_t EventMailbox::newest_ns() const {
  const std::lock_guard lock(mutex_);
  return newest_ns_;
}

std::uint64_t EventMailbox::dropped() const {
  const std::lock_guard lock(mutex_);
  return dropped_;
}

}  // namespace wholehand
