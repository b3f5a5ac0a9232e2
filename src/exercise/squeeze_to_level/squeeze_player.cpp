#include "exercise/squeeze_to_level/squeeze_player.hpp"

#include "core/geometry.hpp"

#include <algorithm>
#include <cmath>

namespace wholehand::squeeze_to_level {
namespace {

// Postures [rad], as in the bar's player.
constexpr double kStretched = 8.0 * kDeg, kHalfBent = 65.0 * kDeg, kClosed = 155.0 * kDeg;
constexpr double kTurnedAside = 5.0 * kDeg, kOpposed = 20.0 * kDeg, kThumbClosed = 27.0 * kDeg;
constexpr double kThumbAlong = kThumbClosed / (kClosed - kHalfBent);  // thumb per finger angle
constexpr double kBack_m = 0.006;                                     // distance from the end of x
constexpr double kBeside_m = 0.024;  // sideways from the contact of the palm
// Peak speeds of a person at pace 1.
constexpr double kArm_m_s = 0.42, kFingers_rad_s = 4.0, kShortest_s = 0.3;
// Speeds and filter of the fingers' target while pressing.
constexpr double kClosing_rad_s = 1.0, kPressing_rad_s = 0.5, kFilter_s = 0.05;

}  // namespace

SqueezePlayer::SqueezePlayer(const BarLayout& layout, const PlayerTraits& traits)
    : layout_(layout),
      opening_rad_s_(traits.opening_rad_s),
      pace_(0.8 + 0.1 * static_cast<double>(traits.seed % 5)),
      share_(0.35 + 0.1 * static_cast<double>(traits.seed / 5 % 4)),
      start_(layout.axes) {
  const auto put = [this](int axis, double value) {
    if (axis >= 0) start_[axis] = std::clamp(value, layout_.lower[axis], layout_.upper[axis]);
  };
  put(layout_.x, -0.07);
  put(layout_.fingers, kHalfBent);
  put(layout_.turn, kTurnedAside);
  SqueezePlayer::reset();
}

void SqueezePlayer::reset() {
  q_ = start_;
  qd_ = AxisVelocity(layout_.axes);
  advanced_ = lost_ = near_ = done_ = let_go_ = false;
  squeeze_n_ = wanted_n_ = rate_rad_s_ = 0.0;
  go(Phase::kDrawBack);
}

AxisPosition SqueezePlayer::goalOf(Phase phase) const noexcept {
  AxisPosition goal = q_;
  const auto put = [&](int axis, double value) {
    if (axis >= 0) goal[axis] = std::clamp(value, layout_.lower[axis], layout_.upper[axis]);
  };
  const auto hand = [&](double fingers, double turn) {
    put(layout_.fingers, fingers);
    put(layout_.turn, turn);
    put(layout_.thumb, 0.0);
  };
  const auto base = [&](double x_m, double y_m, double z_m) {
    put(layout_.x, x_m);
    put(layout_.y, y_m);
    put(layout_.z, z_m);
  };
  const double back_m = layout_.x >= 0 ? layout_.lower[layout_.x] + kBack_m : 0.0;
  const double beside_m = grip_m_.y() - layout_.beside * kBeside_m;
  switch (phase) {
    case Phase::kDrawBack:
    case Phase::kRest:
      put(layout_.x, back_m);
      hand(kHalfBent, kTurnedAside);
      break;
    case Phase::kAlign:
      base(back_m, beside_m, grip_m_.z());
      hand(kStretched, kTurnedAside);
      break;
    case Phase::kEnter:
    case Phase::kLeave:
      base(grip_m_.x(), beside_m, grip_m_.z());
      hand(kStretched, kTurnedAside);
      break;
    case Phase::kTouch:
      base(grip_m_.x(), grip_m_.y(), grip_m_.z());
      hand(kHalfBent, kOpposed);
      break;
    case Phase::kOpen:
      hand(kHalfBent, kTurnedAside);
      break;
    case Phase::kSqueeze:
      break;
  }
  return goal;
}

void SqueezePlayer::go(Phase phase) noexcept {
  phase_ = phase;
  rate_rad_s_ = 0.0;
  const AxisPosition goal = goalOf(phase);
  double longest_s = kShortest_s;
  for (int i = 0; i < goal.size(); ++i) {
    const bool arm = i == layout_.x || i == layout_.y || i == layout_.z;
    const double peak = arm ? kArm_m_s : kFingers_rad_s;
    longest_s = std::max(longest_s, kMinimumJerkPeak * std::abs(goal[i] - q_[i]) / peak);
  }
  reach_.begin(q_, qd_, goal, longest_s / pace_);
  // The palm arrives before the fingers bend, so that they close around the object.
  if (phase == Phase::kTouch && layout_.y >= 0) reach_.during(layout_.y, 0.0, 0.7);
  if (phase == Phase::kTouch && layout_.fingers >= 0) reach_.during(layout_.fingers, 0.2, 1.0);
  for (const int axis : {layout_.fingers, layout_.thumb, layout_.turn}) {
    if (axis >= 0 && goal[axis] < q_[axis]) reach_.limitSpeed(axis, opening_rad_s_);
  }
}

void SqueezePlayer::advance(double period_s, AxisPosition& q, AxisVelocity& qd) noexcept {
  advanced_ = true;
  if (lost_) {  // continues from the hand's present pose
    lost_ = false;
    go(near_ ? Phase::kOpen : Phase::kDrawBack);
  }
  if (phase_ == Phase::kSqueeze) {
    press(period_s);
  } else {
    reach_.advance(period_s, q_, qd_);
  }
  q = q_;
  qd = qd_;
}

// Moves fingers and thumb by a rate; the arm rests.
void SqueezePlayer::press(double period_s) noexcept {
  if (layout_.fingers < 0) return;
  const double lower = kHalfBent, upper = layout_.upper[layout_.fingers];
  double wanted_rad_s = kClosing_rad_s;
  if (let_go_) {
    wanted_rad_s = -kClosing_rad_s;
  } else if (squeeze_n_ > 0.15 * wanted_n_) {
    wanted_rad_s = std::clamp(kPressing_rad_s * (wanted_n_ - squeeze_n_) / wanted_n_,
                              -kPressing_rad_s, kPressing_rad_s);
  }
  const double fingers = q_[layout_.fingers];
  wanted_rad_s = pace_ * std::clamp(wanted_rad_s, (lower - fingers) / 0.2, (upper - fingers) / 0.2);
  wanted_rad_s = std::max(wanted_rad_s, -opening_rad_s_);
  rate_rad_s_ += (wanted_rad_s - rate_rad_s_) * std::min(period_s / kFilter_s, 1.0);
  q_[layout_.fingers] = fingers + rate_rad_s_ * period_s;
  qd_[layout_.fingers] = rate_rad_s_;
  if (layout_.thumb < 0) return;
  q_[layout_.thumb] += kThumbAlong * rate_rad_s_ * period_s;
  qd_[layout_.thumb] = kThumbAlong * rate_rad_s_;
}

void SqueezePlayer::see(const TickRecord& record) noexcept {
  if (!advanced_ && record.intention.size() == layout_.axes) {  // someone else steered the hand
    lost_ = true;
    q_ = record.intention;
    qd_ = AxisVelocity(layout_.axes);
    near_ = record.exercise.alpha > 0.0;
  }
  advanced_ = false;
  const ExerciseRecord& reported = record.exercise;
  if (reported.value_count != kValues) return;  // no values on the way to neutral
  done_ = reported.values[kDone] > 0.5;
  let_go_ = static_cast<Instruction>(reported.values[kInstruction]) == Instruction::kLetGo || done_;
  squeeze_n_ = reported.values[kSqueeze];
  wanted_n_ = std::max(
      reported.values[kGoalLow] + share_ * (reported.values[kGoalHigh] - reported.values[kGoalLow]),
      0.1);
  const BodyState& body = record.bodies[layout_.dispensers[0].body];
  if (phase_ == Phase::kDrawBack || phase_ == Phase::kAlign) {
    grip_m_ = body.position_m.eigen() - layout_.grip_m;
  }
  if (lost_ || (phase_ == Phase::kSqueeze ? !done_ : !reach_.done())) return;
  if (phase_ == Phase::kRest && done_) return;
  go(phase_ == Phase::kRest ? Phase::kDrawBack : static_cast<Phase>(static_cast<int>(phase_) + 1));
}

}  // namespace wholehand::squeeze_to_level
