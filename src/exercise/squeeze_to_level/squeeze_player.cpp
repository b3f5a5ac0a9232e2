#include "exercise/squeeze_to_level/squeeze_player.hpp"

#include <algorithm>
#include <cmath>

namespace wholehand::squeeze_to_level {
namespace {

using namespace approach;

constexpr double kBeside_m = 0.024;  // sideways from the contact of the palm
// Speeds of the fingers' target while pressing.
constexpr double kClosing_rad_s = 1.0, kPressing_rad_s = 0.5;

}  // namespace

SqueezePlayer::SqueezePlayer(const BarLayout& layout, const PlayerTraits& traits)
    : ReachingPlayer(layout),
      opening_rad_s_(traits.opening_rad_s),
      pace_(0.8 + 0.1 * static_cast<double>(traits.seed % 5)),
      share_(0.35 + 0.1 * static_cast<double>(traits.seed / 5 % 4)) {
  start_ = approach::start(layout);
  SqueezePlayer::reset();
}

void SqueezePlayer::reset() {
  toStart();
  near_ = done_ = let_go_ = false;
  squeeze_n_ = wanted_n_ = rate_rad_s_ = 0.0;
  go(Phase::kDrawBack);
}

AxisPosition SqueezePlayer::goalOf(Phase phase) const noexcept {
  Goal goal(layout_, q_);
  const double beside_m = grip_m_.y() - layout_.beside * kBeside_m;
  switch (phase) {
    case Phase::kDrawBack:
    case Phase::kRest:
      return goal.drawBack();
    case Phase::kAlign:
      return goal.pose({back_m(layout_), beside_m, grip_m_.z()}, kStretched, kTurnedAside);
    case Phase::kEnter:
    case Phase::kLeave:
      return goal.pose({grip_m_.x(), beside_m, grip_m_.z()}, kStretched, kTurnedAside);
    case Phase::kTouch:
      return goal.pose(grip_m_, kHalfBent, kOpposed);
    case Phase::kOpen:
      return goal.hand(kHalfBent, kTurnedAside);
    case Phase::kSqueeze:
      break;
  }
  return goal.at();
}

void SqueezePlayer::go(Phase phase) noexcept {
  phase_ = phase;
  rate_rad_s_ = 0.0;
  reachFor(goalOf(phase), pace_, phase == Phase::kTouch, opening_rad_s_);
}

void SqueezePlayer::advance(double period_s, AxisPosition& q, AxisVelocity& qd) noexcept {
  if (takesOver()) go(near_ ? Phase::kOpen : Phase::kDrawBack);
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
  double wanted_rad_s = kClosing_rad_s;
  if (let_go_) {
    wanted_rad_s = -kClosing_rad_s;
  } else if (squeeze_n_ > 0.15 * wanted_n_) {
    wanted_rad_s = std::clamp(kPressing_rad_s * (wanted_n_ - squeeze_n_) / wanted_n_,
                              -kPressing_rad_s, kPressing_rad_s);
  }
  const AxisPosition before = q_;
  closeBy(layout_, wanted_rad_s, pace_, kHalfBent, opening_rad_s_, period_s, rate_rad_s_, q_);
  for (int a = 0; a < qd_.size(); ++a) qd_[a] = (q_[a] - before[a]) / period_s;
}

void SqueezePlayer::see(const TickRecord& record) noexcept {
  if (steeredByOthers(record)) near_ = record.exercise.alpha > 0.0;
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
