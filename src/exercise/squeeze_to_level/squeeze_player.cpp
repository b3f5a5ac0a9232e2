#include "exercise/squeeze_to_level/squeeze_player.hpp"

#include "core/units.hpp"

#include <algorithm>
#include <cmath>

namespace wholehand::squeeze_to_level {
namespace {

// Postures [rad], as the bar's player takes them.
constexpr double kStretched = 8.0 * kDeg, kHalfBent = 65.0 * kDeg, kClosed = 155.0 * kDeg;
constexpr double kTurnedAside = 5.0 * kDeg, kOpposed = 20.0 * kDeg, kThumbClosed = 27.0 * kDeg;
constexpr double kThumbAlong = kThumbClosed / (kClosed - kHalfBent);  // with the fingers
constexpr double kBack_m = 0.006;                                     // before the end of x
constexpr double kBeside_m = 0.024;  // sideways from where the palm touches
// Peak speeds of a person at pace 1.
constexpr double kArm_m_s = 0.42, kFingers_rad_s = 4.0, kShortest_s = 0.3;
// Of the fingers' aim while they press.
constexpr double kClosing_rad_s = 1.0, kPressing_rad_s = 0.5, kFilter_s = 0.05;

}  // namespace

SqueezePlayer::SqueezePlayer(const BarView& view, std::uint64_t seed)
    : view_(view),
      pace_(0.8 + 0.1 * static_cast<double>(seed % 5)),
      share_(0.35 + 0.1 * static_cast<double>(seed / 5 % 4)),
      start_(view.axes) {
  const auto put = [this](int axis, double value) {
    if (axis >= 0) start_[axis] = std::clamp(value, view_.lower[axis], view_.upper[axis]);
  };
  put(view_.x, -0.07);
  put(view_.fingers, kHalfBent);
  put(view_.turn, kTurnedAside);
  SqueezePlayer::reset();
}

void SqueezePlayer::reset() {
  q_ = start_;
  qd_ = AxisVelocity(view_.axes);
  advanced_ = lost_ = near_ = done_ = let_go_ = false;
  squeeze_n_ = wanted_n_ = rate_rad_s_ = 0.0;
  go(Doing::kDrawBack);
}

AxisPosition SqueezePlayer::goalOf(Doing doing) const noexcept {
  AxisPosition goal = q_;
  const auto put = [&](int axis, double value) {
    if (axis >= 0) goal[axis] = std::clamp(value, view_.lower[axis], view_.upper[axis]);
  };
  const auto hand = [&](double fingers, double turn) {
    put(view_.fingers, fingers);
    put(view_.turn, turn);
    put(view_.thumb, 0.0);
  };
  const auto base = [&](double x_m, double y_m, double z_m) {
    put(view_.x, x_m);
    put(view_.y, y_m);
    put(view_.z, z_m);
  };
  const double back_m = view_.x >= 0 ? view_.lower[view_.x] + kBack_m : 0.0;
  const double beside_m = grip_m_.y() - view_.beside * kBeside_m;
  switch (doing) {
    case Doing::kDrawBack:
    case Doing::kRest:
      put(view_.x, back_m);
      hand(kHalfBent, kTurnedAside);
      break;
    case Doing::kAlign:
      base(back_m, beside_m, grip_m_.z());
      hand(kStretched, kTurnedAside);
      break;
    case Doing::kEnter:
    case Doing::kLeave:
      base(grip_m_.x(), beside_m, grip_m_.z());
      hand(kStretched, kTurnedAside);
      break;
    case Doing::kTouch:
      base(grip_m_.x(), grip_m_.y(), grip_m_.z());
      hand(kHalfBent, kOpposed);
      break;
    case Doing::kOpen:
      hand(kHalfBent, kTurnedAside);
      break;
    case Doing::kSqueeze:
      break;
  }
  return goal;
}

void SqueezePlayer::go(Doing doing) noexcept {
  doing_ = doing;
  rate_rad_s_ = 0.0;
  const AxisPosition goal = goalOf(doing);
  double longest_s = kShortest_s;
  for (int i = 0; i < goal.size(); ++i) {
    const bool arm = i == view_.x || i == view_.y || i == view_.z;
    const double peak = arm ? kArm_m_s : kFingers_rad_s;
    longest_s = std::max(longest_s, 1.875 * std::abs(goal[i] - q_[i]) / peak);
  }
  reach_.begin(q_, qd_, goal, longest_s / pace_);
  // The palm comes before the fingers bend, so that they close about the object.
  if (doing == Doing::kTouch && view_.y >= 0) reach_.during(view_.y, 0.0, 0.7);
  if (doing == Doing::kTouch && view_.fingers >= 0) reach_.during(view_.fingers, 0.2, 1.0);
}

void SqueezePlayer::advance(double period_s, AxisPosition& q, AxisVelocity& qd) noexcept {
  advanced_ = true;
  if (lost_) {  // goes on from where the hand is
    lost_ = false;
    go(near_ ? Doing::kOpen : Doing::kDrawBack);
  }
  if (doing_ == Doing::kSqueeze) {
    press(period_s);
  } else {
    reach_.advance(period_s, q_, qd_);
  }
  q = q_;
  qd = qd_;
}

// The fingers go by a rate, the thumb with them; the arm rests.
void SqueezePlayer::press(double period_s) noexcept {
  if (view_.fingers < 0) return;
  const double lower = kHalfBent, upper = view_.upper[view_.fingers];
  double wanted_rad_s = kClosing_rad_s;
  if (let_go_) {
    wanted_rad_s = -kClosing_rad_s;
  } else if (squeeze_n_ > 0.15 * wanted_n_) {
    wanted_rad_s = std::clamp(kPressing_rad_s * (wanted_n_ - squeeze_n_) / wanted_n_,
                              -kPressing_rad_s, kPressing_rad_s);
  }
  const double fingers = q_[view_.fingers];
  wanted_rad_s = pace_ * std::clamp(wanted_rad_s, (lower - fingers) / 0.2, (upper - fingers) / 0.2);
  rate_rad_s_ += (wanted_rad_s - rate_rad_s_) * std::min(period_s / kFilter_s, 1.0);
  q_[view_.fingers] = fingers + rate_rad_s_ * period_s;
  qd_[view_.fingers] = rate_rad_s_;
  if (view_.thumb < 0) return;
  q_[view_.thumb] += kThumbAlong * rate_rad_s_ * period_s;
  qd_[view_.thumb] = kThumbAlong * rate_rad_s_;
}

void SqueezePlayer::see(const TickRecord& record) noexcept {
  if (!advanced_ && record.intention.size() == view_.axes) {  // somebody else moved the hand
    lost_ = true;
    q_ = record.intention;
    qd_ = AxisVelocity(view_.axes);
    near_ = record.exercise.alpha > 0.0;
  }
  advanced_ = false;
  const ExerciseRecord& told = record.exercise;
  if (told.value_count != kValues) return;  // on the way to neutral
  done_ = told.values[kDone] > 0.5;
  let_go_ = static_cast<Instruction>(told.values[kInstruction]) == Instruction::kLetGo || done_;
  squeeze_n_ = told.values[kSqueeze];
  wanted_n_ = std::max(
      told.values[kGoalLow] + share_ * (told.values[kGoalHigh] - told.values[kGoalLow]), 0.1);
  const BodyState& body = record.bodies[static_cast<std::size_t>(view_.dispensers[0].body)];
  if (doing_ == Doing::kDrawBack || doing_ == Doing::kAlign) {
    grip_m_ = body.position_m.eigen() - view_.grip_m;
  }
  if (lost_ || (doing_ == Doing::kSqueeze ? !done_ : !reach_.done())) return;
  if (doing_ == Doing::kRest && done_) return;
  go(doing_ == Doing::kRest ? Doing::kDrawBack : static_cast<Doing>(static_cast<int>(doing_) + 1));
}

}  // namespace wholehand::squeeze_to_level
