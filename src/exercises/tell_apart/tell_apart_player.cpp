#include "exercises/tell_apart/tell_apart_player.hpp"

#include "loop/psychometrics/comparison.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace wholehand::tell_apart {
namespace {

using namespace approach;

constexpr double kNoise = 0.222;  // σ of Jones's observers of viscosity
constexpr double kClosing_rad_s = 1.2, kPressing_rad_s = 0.8;
constexpr double kAim = 1.12;  // share of the asked depth at which it holds

}  // namespace

TellApartPlayer::TellApartPlayer(const PlayerReach& hand, std::array<int, kBottles> bodies,
                                 const Eigen::Vector3d& center_m, const PlayerTraits& traits)
    : ClosingPlayer(hand, traits.opening_rad_s, 0.9 + 0.1 * static_cast<double>(traits.seed % 3)),
      bodies_(bodies),
      seed_(traits.seed) {
  start_ = approach::startAt(hand, center_m - hand.grip_m);
  TellApartPlayer::reset();
}

void TellApartPlayer::reset() {
  toStart();
  random_ = seed_;
  at_ = 0;
  to_ = choice_ = -1;
  near_ = done_ = felt_ = false;
  pressed_ = squeeze_n_ = 0.0;
  go(Phase::kDrawBack);
}

double TellApartPlayer::uniform() noexcept {
  random_ = splitMix64(random_);
  return (static_cast<double>(random_ >> 11) + 0.5) * 0x1p-53;
}

int TellApartPlayer::chosen(double x) noexcept {
  const double radius = std::sqrt(-2.0 * std::log(uniform()));
  const double normal = radius * std::cos(2.0 * std::numbers::pi * uniform());
  return x + std::numbers::sqrt2 * kNoise * normal > 0.0 ? 1 : 0;
}

AxisPosition TellApartPlayer::goalOf(Phase phase) const noexcept {
  Goal goal(hand_, q_);
  const Eigen::Vector3d& grip_m = grips_m_[at_];
  const double beside_m = grip_m.y() - hand_.beside * kBeside_m;
  switch (phase) {
    case Phase::kDrawBack:
    case Phase::kRest:
      return goal.drawBack();
    case Phase::kAlign:
      return goal.pose({back_m(hand_), beside_m, grip_m.z()}, kStretched, kTurnedAside);
    case Phase::kEnter:
      return goal.pose({grip_m.x(), beside_m, grip_m.z()}, kStretched, kTurnedAside);
    case Phase::kTouch:
      return goal.pose(grip_m, kHalfBent, kOpposed);
    case Phase::kOpen:
      return goal.hand(kHalfBent, kOpposed);
    case Phase::kAside:
      return goal.put(hand_.y, grip_m.y() - 0.4 * hand_.beside * kBeside_m);
    case Phase::kPass:
      return goal.base({grip_m.x(), grip_m.y() - 0.4 * hand_.beside * kBeside_m, grip_m.z()});
    case Phase::kSqueeze:
      break;
  }
  return goal.at();
}

void TellApartPlayer::go(Phase phase) noexcept {
  phase_ = phase;
  moveTo(goalOf(phase), phase == Phase::kTouch);
}

void TellApartPlayer::advance(double period_s, AxisPosition& q, AxisVelocity& qd) noexcept {
  if (takesOver()) go(near_ ? Phase::kOpen : Phase::kDrawBack);
  moveOn(phase_ == Phase::kSqueeze ? std::optional(pressingRate()) : std::nullopt, period_s, q, qd);
}

double TellApartPlayer::pressingRate() const noexcept {
  if (!felt_) return 0.0;
  if (pressed_ <= 0.0) return kClosing_rad_s;
  return std::clamp(4.0 * kPressing_rad_s * (kAim - pressed_), -kPressing_rad_s, kPressing_rad_s);
}

void TellApartPlayer::onRecord(const TickRecord& record) noexcept {
  if (steeredByOthers(record)) near_ = record.exercise.alpha > 0.0;
  const ExerciseRecord& reported = record.exercise;
  if (reported.value_count != kValues) return;  // records have no values during the ramp to neutral
  done_ = reported.values[kDone] > 0.5;
  pressed_ = reported.values[kPressed];
  squeeze_n_ = reported.values[kSqueeze];
  felt_ = static_cast<int>(reported.values[kAt]) == at_;
  const auto instruction = static_cast<Instruction>(reported.values[kInstruction]);
  const bool answering = reported.values[kAnswering] > 0.5;
  if (!answering) {
    choice_ = -1;
  } else if (choice_ < 0) {
    choice_ = chosen(reported.values[kX]);
  }
  to_ = instruction == Instruction::kLetGo || instruction == Instruction::kOneAtATime ? -1
        : answering                                                                   ? choice_
                    : static_cast<int>(reported.values[kWanted]);
  for (int b = 0; b < kBottles; ++b) {
    grips_m_[b] = record.bodies[bodies_[b]].position_m.eigen() - hand_.grip_m;
  }
  if (!lost_) next();
}

// Follows the exercise from phase to phase.
void TellApartPlayer::next() noexcept {
  if (phase_ == Phase::kSqueeze) {
    if (to_ != at_) go(Phase::kOpen);
    return;
  }
  if (!reach_.done()) return;
  switch (phase_) {
    case Phase::kOpen:
      if (done_) return go(Phase::kDrawBack);
      if (to_ == at_) return go(Phase::kSqueeze);
      if (to_ >= 0) go(Phase::kAside);
      return;
    case Phase::kAside:
      if (to_ >= 0) at_ = to_;
      return go(Phase::kPass);
    case Phase::kPass:
      return go(Phase::kTouch);
    case Phase::kTouch:
      return go(Phase::kSqueeze);
    case Phase::kDrawBack:
      if (to_ >= 0) at_ = to_;
      return go(done_ ? Phase::kRest : Phase::kAlign);
    case Phase::kRest:
      if (!done_) go(Phase::kDrawBack);
      return;
    default:
      return go(static_cast<Phase>(static_cast<int>(phase_) + 1));
  }
}

}  // namespace wholehand::tell_apart
