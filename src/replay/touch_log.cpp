#include "replay/touch_log.hpp"

#include <algorithm>

namespace wholehand {
namespace {
constexpr double kBridge_s = 0.2, kJitter_m = 1e-3;
}

double BodyStory::longest_s() const {
  double most = 0.0;
  for (const Touch& t : touches) most = std::max(most, t.to_s - t.from_s);
  return most;
}

double BodyStory::largestForce_n() const {
  double most = 0.0;
  for (const Touch& t : touches) most = std::max(most, t.largest_force_n);
  return most;
}

double BodyStory::held_s() const {
  double sum = 0.0;
  for (const Touch& t : touches) sum += t.held_s;
  return sum;
}

void TouchLog::contact(double time_s, double period_s, bool touching, double force_n, bool held) {
  if (!touching) return;
  std::vector<Touch>& touches = story_.touches;
  if (touches.empty() || time_s - touches.back().to_s > kBridge_s) {
    touches.push_back({body_, time_s, time_s, 0.0, 0.0});
  }
  Touch& touch = touches.back();
  touch.to_s = time_s + period_s;
  touch.largest_force_n = std::max(touch.largest_force_n, force_n);
  if (held) touch.held_s += period_s;
}

void TouchLog::position(const Eigen::Vector3d& position_m) {
  if (!position_m.allFinite()) return;
  if (!here_) anchor_m_ = position_m;
  seen_ = here_ = true;
  const double step_m = (position_m - anchor_m_).norm();
  if (step_m < kJitter_m) return;
  story_.travelled_m += step_m;
  anchor_m_ = position_m;
}

}  // namespace wholehand
