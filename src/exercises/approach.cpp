#include "exercises/approach.hpp"

#include "exercises/player_reach.hpp"

#include <algorithm>
#include <cmath>

namespace wholehand::approach {
namespace {

constexpr double kBack_m = 0.006;  // distance of the withdrawn hand from the end of the x axis
constexpr double kStart_m = -0.07;
constexpr double kClears_m = 0.115;  // from the grip to where half-bent fingers are clear of it
constexpr double kShortest_s = 0.3, kCloseFilter_s = 0.05, kToEnd_s = 0.2;

}  // namespace

const AxisPosition& Goal::put(int axis, double value) noexcept {
  if (axis >= 0) at_[axis] = std::clamp(value, reach_.lower[axis], reach_.upper[axis]);
  return at_;
}

const AxisPosition& Goal::hand(double fingers, double turn, double thumb) noexcept {
  put(reach_.fingers, fingers);
  put(reach_.turn, turn);
  return put(reach_.thumb, thumb);
}

const AxisPosition& Goal::base(const Eigen::Vector3d& at_m) noexcept {
  put(reach_.x, at_m.x());
  put(reach_.y, at_m.y());
  return put(reach_.z, at_m.z());
}

const AxisPosition& Goal::pose(const Eigen::Vector3d& base_m, double fingers,
                               double turn) noexcept {
  base(base_m);
  return hand(fingers, turn);
}

const AxisPosition& Goal::drawBack() noexcept {
  put(reach_.x, back_m(reach_));
  return hand(isNarrow(reach_) ? kStretched : kHalfBent, kTurnedAside);
}

double back_m(const PlayerReach& hand) noexcept {
  return hand.x >= 0 ? hand.lower[hand.x] + kBack_m : 0.0;
}

AxisPosition start(const PlayerReach& hand) {
  Goal goal(hand, AxisPosition(hand.axes));
  goal.put(hand.x, kStart_m);
  goal.put(hand.fingers, kHalfBent);
  goal.put(hand.turn, kTurnedAside);
  return goal.at();
}

bool isNarrow(const PlayerReach& hand) noexcept {
  return hand.x >= 0 && hand.upper[hand.x] - hand.lower[hand.x] < kClears_m;
}

AxisPosition startAt(const PlayerReach& hand, const Eigen::Vector3d& base_m) {
  if (!isNarrow(hand)) return start(hand);
  Goal goal(hand, AxisPosition(hand.axes));
  return goal.pose({back_m(hand), base_m.y() - hand.beside * kBeside_m, base_m.z()}, kStretched,
                   kTurnedAside);
}

double durationTo(const PlayerReach& hand, const AxisPosition& from,
                  const AxisPosition& goal) noexcept {
  double longest_s = kShortest_s;
  for (int i = 0; i < goal.size(); ++i) {
    const bool arm = i == hand.x || i == hand.y || i == hand.z;
    const double peak = arm ? kArm_m_s : kFingers_rad_s;
    longest_s = std::max(longest_s, kMinimumJerkPeak * std::abs(goal[i] - from[i]) / peak);
  }
  return longest_s;
}

void limitOpening(const PlayerReach& hand, const AxisPosition& from, double opening_rad_s,
                  Reach& reach) noexcept {
  for (const int axis : {hand.fingers, hand.thumb, hand.turn}) {
    if (axis >= 0 && reach.goal()[axis] < from[axis]) reach.limitSpeed(axis, opening_rad_s);
  }
}

void ReachingPlayer::toStart() noexcept {
  q_ = start_;
  qd_ = AxisVelocity(hand_.axes);
  advanced_ = lost_ = false;
}

void ReachingPlayer::reachFor(const AxisPosition& goal, double pace, bool palm_first,
                              double opening_rad_s) noexcept {
  reach_.begin(q_, qd_, goal, durationTo(hand_, q_, goal) / pace);
  if (palm_first && hand_.y >= 0) reach_.during(hand_.y, 0.0, 0.7);
  if (palm_first && hand_.fingers >= 0) reach_.during(hand_.fingers, 0.2, 1.0);
  limitOpening(hand_, q_, opening_rad_s, reach_);
}

bool ReachingPlayer::steeredByOthers(const TickRecord& record) noexcept {
  if (std::exchange(advanced_, false) || record.intention.size() != hand_.axes) return false;
  lost_ = true;
  q_ = record.intention;
  qd_ = AxisVelocity(hand_.axes);
  return true;
}

void ClosingPlayer::moveTo(const AxisPosition& goal, bool palm_first) noexcept {
  rate_rad_s_ = 0.0;
  reachFor(goal, pace_, palm_first, opening_rad_s_);
}

void ClosingPlayer::moveOn(std::optional<double> wanted_rad_s, double period_s, AxisPosition& q,
                           AxisVelocity& qd) noexcept {
  if (wanted_rad_s) {
    const AxisPosition before = q_;
    closeBy(*wanted_rad_s, kHalfBent, period_s);
    for (int a = 0; a < qd_.size(); ++a) qd_[a] = (q_[a] - before[a]) / period_s;
  } else {
    reach_.advance(period_s, q_, qd_);
  }
  q = q_;
  qd = qd_;
}

void ClosingPlayer::closeBy(double wanted_rad_s, double lower, double period_s) noexcept {
  if (hand_.fingers < 0) return;
  double& fingers = q_[hand_.fingers];
  const double upper = hand_.upper[hand_.fingers];
  double wanted =
      pace_ * std::clamp(wanted_rad_s, (lower - fingers) / kToEnd_s, (upper - fingers) / kToEnd_s);
  wanted = std::max(wanted, -opening_rad_s_);
  rate_rad_s_ += (wanted - rate_rad_s_) * std::min(period_s / kCloseFilter_s, 1.0);
  fingers += rate_rad_s_ * period_s;
  if (hand_.thumb < 0) return;
  q_[hand_.thumb] = std::clamp(q_[hand_.thumb] + kThumbAlong * rate_rad_s_ * period_s,
                               hand_.lower[hand_.thumb], hand_.upper[hand_.thumb]);
}

}  // namespace wholehand::approach
