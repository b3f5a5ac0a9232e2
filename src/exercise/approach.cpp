#include "exercise/approach.hpp"

#include <algorithm>
#include <cmath>

namespace wholehand::approach {
namespace {

constexpr double kBack_m = 0.006;  // distance from the end of x
constexpr double kStart_m = -0.07;
constexpr double kShortest_s = 0.3, kCloseFilter_s = 0.05, kToEnd_s = 0.2;

}  // namespace

const AxisPosition& Goal::put(int axis, double value) noexcept {
  if (axis >= 0) at_[axis] = std::clamp(value, layout_.lower[axis], layout_.upper[axis]);
  return at_;
}

const AxisPosition& Goal::hand(double fingers, double turn, double thumb) noexcept {
  put(layout_.fingers, fingers);
  put(layout_.turn, turn);
  return put(layout_.thumb, thumb);
}

const AxisPosition& Goal::base(const Eigen::Vector3d& at_m) noexcept {
  put(layout_.x, at_m.x());
  put(layout_.y, at_m.y());
  return put(layout_.z, at_m.z());
}

const AxisPosition& Goal::pose(const Eigen::Vector3d& base_m, double fingers,
                               double turn) noexcept {
  base(base_m);
  return hand(fingers, turn);
}

const AxisPosition& Goal::drawBack() noexcept {
  put(layout_.x, back_m(layout_));
  return hand(kHalfBent, kTurnedAside);
}

double back_m(const BarLayout& layout) noexcept {
  return layout.x >= 0 ? layout.lower[layout.x] + kBack_m : 0.0;
}

AxisPosition start(const BarLayout& layout) {
  Goal goal(layout, AxisPosition(layout.axes));
  goal.put(layout.x, kStart_m);
  goal.put(layout.fingers, kHalfBent);
  goal.put(layout.turn, kTurnedAside);
  return goal.at();
}

double durationTo(const BarLayout& layout, const AxisPosition& from,
                  const AxisPosition& goal) noexcept {
  double longest_s = kShortest_s;
  for (int i = 0; i < goal.size(); ++i) {
    const bool arm = i == layout.x || i == layout.y || i == layout.z;
    const double peak = arm ? kArm_m_s : kFingers_rad_s;
    longest_s = std::max(longest_s, kMinimumJerkPeak * std::abs(goal[i] - from[i]) / peak);
  }
  return longest_s;
}

void limitOpening(const BarLayout& layout, const AxisPosition& from, double opening_rad_s,
                  Reach& reach) noexcept {
  for (const int axis : {layout.fingers, layout.thumb, layout.turn}) {
    if (axis >= 0 && reach.goal()[axis] < from[axis]) reach.limitSpeed(axis, opening_rad_s);
  }
}

void closeBy(const BarLayout& layout, double wanted_rad_s, double pace, double lower,
             double opening_rad_s, double period_s, double& rate_rad_s, AxisPosition& q) noexcept {
  if (layout.fingers < 0) return;
  double& fingers = q[layout.fingers];
  const double upper = layout.upper[layout.fingers];
  double wanted =
      pace * std::clamp(wanted_rad_s, (lower - fingers) / kToEnd_s, (upper - fingers) / kToEnd_s);
  wanted = std::max(wanted, -opening_rad_s);
  rate_rad_s += (wanted - rate_rad_s) * std::min(period_s / kCloseFilter_s, 1.0);
  fingers += rate_rad_s * period_s;
  if (layout.thumb < 0) return;
  q[layout.thumb] = std::clamp(q[layout.thumb] + kThumbAlong * rate_rad_s * period_s,
                               layout.lower[layout.thumb], layout.upper[layout.thumb]);
}

void ReachingPlayer::toStart() noexcept {
  q_ = start_;
  qd_ = AxisVelocity(layout_.axes);
  advanced_ = lost_ = false;
}

void ReachingPlayer::reachFor(const AxisPosition& goal, double pace, bool palm_first,
                              double opening_rad_s) noexcept {
  reach_.begin(q_, qd_, goal, durationTo(layout_, q_, goal) / pace);
  if (palm_first && layout_.y >= 0) reach_.during(layout_.y, 0.0, 0.7);
  if (palm_first && layout_.fingers >= 0) reach_.during(layout_.fingers, 0.2, 1.0);
  limitOpening(layout_, q_, opening_rad_s, reach_);
}

bool ReachingPlayer::steeredByOthers(const TickRecord& record) noexcept {
  if (std::exchange(advanced_, false) || record.intention.size() != layout_.axes) return false;
  lost_ = true;
  q_ = record.intention;
  qd_ = AxisVelocity(layout_.axes);
  return true;
}

}  // namespace wholehand::approach
