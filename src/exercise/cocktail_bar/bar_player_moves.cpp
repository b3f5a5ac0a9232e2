#include "core/units.hpp"
#include "exercise/cocktail_bar/bar_player.hpp"

#include <algorithm>
#include <cmath>

// Movements of the player's hand.
namespace wholehand {
namespace {

// Postures [rad]. Stretched fingers pass beside a dispenser; half-bent ones pass in front of the
// row.
constexpr double kStretched = 8.0 * kDeg, kHalfBent = 65.0 * kDeg, kClosed = 155.0 * kDeg;
constexpr double kTurnedAside = 5.0 * kDeg, kOpposed = 20.0 * kDeg;
// The thumb presses less than four fingers do. More would tip over a free bottle.
constexpr double kThumbClosed = 27.0 * kDeg;
constexpr double kThumbAlong = kThumbClosed / (kClosed - kHalfBent);  // thumb per finger angle
constexpr double kBack_m = 0.006;                                     // distance from the end of x
constexpr double kDrawnBack_m = 0.001;  // tolerance of a withdrawn hand
constexpr double kHeldBack_m = 0.01;    // a hand farther from where it was drawn back to ...
constexpr double kHeldBack_s = 1.0;     // ... after this time is held by something
constexpr double kBeside_m = 0.024;     // sideways from the contact of the palm

// Peak speeds of a person at pace 1.
constexpr double kArm_m_s = 0.42, kFingers_rad_s = 4.0;
constexpr double kShortest_s = 0.3;

// Motion of the fingers' target while pressing.
constexpr double kGripFilter_s = 0.05;
constexpr double kPastRange = 30.0 * kDeg;  // target beyond the range during a grip
constexpr double kGripEnd_s = 0.2;          // time to come to rest at the end of the range

}  // namespace

double BarPlayer::durationTo(const AxisPosition& goal) const noexcept {
  double longest_s = kShortest_s;
  for (int i = 0; i < goal.size(); ++i) {
    const bool arm = i == layout_.x || i == layout_.y || i == layout_.z;
    const double peak = arm ? kArm_m_s : kFingers_rad_s;
    longest_s = std::max(longest_s, 1.875 * std::abs(goal[i] - q_[i]) / peak);
  }
  return longest_s / character_.pace;
}

/// x of the withdrawn hand.
double BarPlayer::back_m() const noexcept {
  return layout_.x >= 0 ? layout_.lower[layout_.x] + kBack_m : 0.0;
}

bool BarPlayer::drawnBack() const noexcept {
  return layout_.x < 0 || q_[layout_.x] < back_m() + kDrawnBack_m;
}

/// A hand between two dispensers is clamped by the force that pulls it sideways.
bool BarPlayer::isHeldBack() const noexcept {
  return layout_.x >= 0 && since_s_ > kHeldBack_s && measured_[layout_.x] > back_m() + kHeldBack_m;
}

AxisPosition BarPlayer::goalOf(Phase phase) const noexcept {
  AxisPosition goal = q_;
  const auto put = [&](int axis, double value) {
    if (axis >= 0) goal[axis] = std::clamp(value, layout_.lower[axis], layout_.upper[axis]);
  };
  const auto hand = [&](double fingers, double turn, double thumb) {
    put(layout_.fingers, fingers);
    put(layout_.turn, turn);
    put(layout_.thumb, thumb);
  };
  const auto base = [&](const Eigen::Vector3d& at) {
    put(layout_.x, at.x());
    put(layout_.y, at.y());
    put(layout_.z, at.z());
  };
  const Eigen::Vector3d beside = grip_ - Eigen::Vector3d(0.0, layout_.beside * kBeside_m, 0.0);
  switch (phase) {
    case Phase::kDrawBack:
      put(layout_.x, back_m());
      hand(kHalfBent, kTurnedAside, 0.0);
      break;
    case Phase::kFree:
      for (const int axis : {layout_.y, layout_.z}) {
        if (axis >= 0) put(axis, measured_[axis]);
      }
      put(layout_.x, back_m());
      hand(kStretched, kTurnedAside, 0.0);
      break;
    case Phase::kAlign:
      base({back_m(), beside.y(), beside.z()});
      hand(kHalfBent, kTurnedAside, 0.0);
      break;
    case Phase::kEnter:
      base(beside);
      hand(kStretched, kTurnedAside, 0.0);
      break;
    case Phase::kTouch:
      base(grip_);
      hand(kHalfBent, kOpposed, 0.0);
      break;
    case Phase::kOpen:
      hand(kHalfBent, kTurnedAside, 0.0);
      break;
    case Phase::kLeave:
      base(beside);
      hand(kStretched, kTurnedAside, 0.0);
      break;
    case Phase::kLift:
      put(layout_.z, over_.z());
      break;
    case Phase::kCarry:
      base(over_);
      break;
    case Phase::kReturn:
      base({grip_.x(), grip_.y(), over_.z()});
      break;
    case Phase::kLower:
      base(grip_);
      break;
    case Phase::kWait:
    case Phase::kSqueeze:
    case Phase::kEase:
      break;
  }
  return goal;
}

// Times the axes so that fingers pass beside dispensers and not through them.
void BarPlayer::shape(Phase phase) noexcept {
  const auto during = [this](int axis, double from, double to) {
    if (axis >= 0) reach_.during(axis, from, to);
  };
  if (phase == Phase::kEnter) {
    during(layout_.fingers, 0.0, 0.45);
    during(layout_.x, 0.3, 1.0);
  } else if (phase == Phase::kTouch) {
    during(layout_.y, 0.0, 0.7);
    during(layout_.fingers, 0.2, 1.0);
    during(layout_.turn, 0.3, 1.0);
  } else if (phase == Phase::kLeave) {
    during(layout_.y, 0.0, 0.7);
    during(layout_.fingers, 0.2, 1.0);
  } else if (phase == Phase::kDrawBack) {
    during(layout_.x, 0.0, 0.75);
    during(layout_.fingers, 0.5, 1.0);
  } else if (phase == Phase::kFree) {
    during(layout_.fingers, 0.0, 0.5);
    during(layout_.x, 0.4, 1.0);
  }
}

void BarPlayer::go(Phase phase, double slower) noexcept {
  phase_ = phase;
  since_s_ = 0.0;
  rate_ = wanted_rate_ = 0.0;
  grips_ = false;
  settled_s_ = stalled_s_ = 0.0;
  if (phase == Phase::kTouch) share_ = character_.share;
  const AxisPosition goal = goalOf(phase);
  reach_.begin(q_, qd_, goal, slower * durationTo(goal));
  shape(phase);
  if (layout_.fingers >= 0) fingers_ = q_[layout_.fingers];
  if (layout_.thumb >= 0) {
    thumb_ = q_[layout_.thumb] - kThumbAlong * (fingers_ - kHalfBent);
  }
}

void BarPlayer::tremble(double period_s, AxisPosition& q, AxisVelocity& qd) noexcept {
  trembling_s_ += period_s;
  // The tremor fades in, so that the motion starts at the start pose.
  const double swell = std::min(trembling_s_, 1.0), slope = trembling_s_ < 1.0 ? 1.0 : 0.0;
  for (int i = 0; i < q.size(); ++i) {
    const bool arm = i == layout_.x || i == layout_.y || i == layout_.z;
    const double size = character_.tremor_m * (arm ? 1.0 : 10.0);
    const double phase = character_.tremor_phase + 1.7 * i + character_.tremor_rad_s * trembling_s_;
    q[i] += size * swell * std::sin(phase);
    qd[i] += size * (swell * character_.tremor_rad_s * std::cos(phase) + slope * std::sin(phase));
  }
}

// Moves fingers and thumb by rates; the arm rests.
void BarPlayer::press(double period_s) noexcept {
  if (layout_.fingers < 0) return;
  // A large hand on a bottle is far from closed. A firm grip needs a target beyond the fingers'
  // range.
  const double end = layout_.upper[layout_.fingers] + (grips_ ? kPastRange : 0.0);
  const double wanted =
      std::clamp(wanted_rate_, -(fingers_ - kHalfBent) / kGripEnd_s, (end - fingers_) / kGripEnd_s);
  rate_ += (wanted - rate_) * std::min(period_s / kGripFilter_s, 1.0);
  fingers_ += rate_ * period_s;
  q_[layout_.fingers] = fingers_;
  qd_[layout_.fingers] = rate_;
  if (layout_.thumb < 0) return;
  q_[layout_.thumb] = thumb_ + kThumbAlong * (fingers_ - kHalfBent);
  qd_[layout_.thumb] = kThumbAlong * rate_;
}

}  // namespace wholehand
