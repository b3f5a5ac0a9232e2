#include "replay/touch_log.hpp"

#include <algorithm>
#include <iterator>

namespace wholehand {
namespace {
constexpr double kBridge_s = 0.2, kJitter_m = 1e-3;
}

std::vector<Touch> BodyStory::persons() const {
  std::vector<Touch> out;
  std::copy_if(touches.begin(), touches.end(), std::back_inserter(out),
               [](const Touch& touch) { return touch.moved.isPersons(); });
  return out;
}

void TouchLog::contact(const BodyContact& contact, const MovedTime& before, const MovedTime& now) {
  std::vector<Touch>& touches = story_.touches;
  if (touches.empty() || contact.time_s - touches.back().to_s > kBridge_s) {
    touches.push_back({body_, contact.time_s, contact.time_s, 0.0, 0.0, {}});
    begin_ = before;
  }
  Touch& touch = touches.back();
  touch.to_s = contact.time_s + contact.duration_s;
  touch.largest_force_n = std::max(touch.largest_force_n, contact.force_n);
  if (contact.held) touch.held_s += contact.duration_s;
  touch.moved = now - begin_;
}

void TouchLog::position(const Eigen::Vector3d& position_m, bool person) {
  if (!position_m.allFinite()) return;
  if (!here_) anchor_m_ = position_m;
  seen_ = here_ = true;
  const double step_m = (position_m - anchor_m_).norm();
  if (step_m < kJitter_m) return;
  if (person) story_.travelled_m += step_m;
  anchor_m_ = position_m;
}

}  // namespace wholehand
