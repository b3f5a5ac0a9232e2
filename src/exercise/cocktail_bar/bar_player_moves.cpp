#include "core/units.hpp"
#include "exercise/cocktail_bar/bar_player.hpp"

#include <algorithm>
#include <cmath>

// How the hand goes where the player wants it.
namespace wholehand {
namespace {

// Postures [rad]. Stretched, the fingers pass beside a dispenser; half bent, they pass in front of
// the row.
constexpr double kStretched = 8.0 * kDeg, kHalfBent = 65.0 * kDeg, kClosed = 155.0 * kDeg;
constexpr double kTurnedAside = 5.0 * kDeg, kOpposed = 20.0 * kDeg;
// The thumb presses less than four fingers do: more would turn a bottle that stands free over.
constexpr double kThumbClosed = 27.0 * kDeg;
constexpr double kThumbAlong = kThumbClosed / (kClosed - kHalfBent);  // with the fingers
constexpr double kBack_m = 0.006;                                     // before the end of x
constexpr double kDrawnBack_m = 0.001;                                // as good as there
constexpr double kBeside_m = 0.024;  // sideways from where the palm touches

// Peak speeds of a person at pace 1.
constexpr double kArm_m_s = 0.42, kFingers_rad_s = 4.0;
constexpr double kShortest_s = 0.3;

// Of the fingers' aim while they press.
constexpr double kGripFilter_s = 0.05;
constexpr double kPastRange = 30.0 * kDeg;  // of an intention, while something is gripped
constexpr double kGripEnd_s = 0.2;          // comes to rest at the end of the range in this time

}  // namespace

double BarPlayer::durationTo(const AxisPosition& goal) const noexcept {
  double longest_s = kShortest_s;
  for (int i = 0; i < goal.size(); ++i) {
    const bool arm = i == view_.x || i == view_.y || i == view_.z;
    const double peak = arm ? kArm_m_s : kFingers_rad_s;
    longest_s = std::max(longest_s, 1.875 * std::abs(goal[i] - q_[i]) / peak);
  }
  return longest_s / character_.pace;
}

/// x of the hand that is drawn back.
double BarPlayer::back_m() const noexcept {
  return view_.x >= 0 ? view_.lower[view_.x] + kBack_m : 0.0;
}

bool BarPlayer::drawnBack() const noexcept {
  return view_.x < 0 || q_[view_.x] < back_m() + kDrawnBack_m;
}

AxisPosition BarPlayer::goalOf(Doing doing) const noexcept {
  AxisPosition goal = q_;
  const auto put = [&](int axis, double value) {
    if (axis >= 0) goal[axis] = std::clamp(value, view_.lower[axis], view_.upper[axis]);
  };
  const auto hand = [&](double fingers, double turn, double thumb) {
    put(view_.fingers, fingers);
    put(view_.turn, turn);
    put(view_.thumb, thumb);
  };
  const auto base = [&](const Eigen::Vector3d& at) {
    put(view_.x, at.x());
    put(view_.y, at.y());
    put(view_.z, at.z());
  };
  const Eigen::Vector3d beside = grip_ - Eigen::Vector3d(0.0, view_.beside * kBeside_m, 0.0);
  switch (doing) {
    case Doing::kDrawBack:
      put(view_.x, back_m());
      hand(kHalfBent, kTurnedAside, 0.0);
      break;
    case Doing::kAlign:
      base({back_m(), beside.y(), beside.z()});
      hand(kHalfBent, kTurnedAside, 0.0);
      break;
    case Doing::kEnter:
      base(beside);
      hand(kStretched, kTurnedAside, 0.0);
      break;
    case Doing::kTouch:
      base(grip_);
      hand(kHalfBent, kOpposed, 0.0);
      break;
    case Doing::kOpen:
      hand(kHalfBent, kTurnedAside, 0.0);
      break;
    case Doing::kLeave:
      base(beside);
      hand(kStretched, kTurnedAside, 0.0);
      break;
    case Doing::kLift:
      put(view_.z, over_.z());
      break;
    case Doing::kCarry:
      base(over_);
      break;
    case Doing::kReturn:
      base({grip_.x(), grip_.y(), over_.z()});
      break;
    case Doing::kLower:
      base(grip_);
      break;
    case Doing::kWait:
    case Doing::kSqueeze:
    case Doing::kEase:
      break;
  }
  return goal;
}

// Which axis moves when, so that fingers pass beside dispensers and not through them.
void BarPlayer::shape(Doing doing) noexcept {
  const auto during = [this](int axis, double from, double to) {
    if (axis >= 0) reach_.during(axis, from, to);
  };
  if (doing == Doing::kEnter) {
    during(view_.fingers, 0.0, 0.45);
    during(view_.x, 0.3, 1.0);
  } else if (doing == Doing::kTouch) {
    during(view_.y, 0.0, 0.7);
    during(view_.fingers, 0.2, 1.0);
    during(view_.turn, 0.3, 1.0);
  } else if (doing == Doing::kLeave) {
    during(view_.y, 0.0, 0.7);
    during(view_.fingers, 0.2, 1.0);
  } else if (doing == Doing::kDrawBack) {
    during(view_.x, 0.0, 0.75);
    during(view_.fingers, 0.5, 1.0);
  }
}

void BarPlayer::go(Doing doing) noexcept {
  doing_ = doing;
  since_s_ = 0.0;
  rate_ = wanted_rate_ = 0.0;
  grips_ = false;
  settled_s_ = vain_s_ = 0.0;
  if (doing == Doing::kTouch) share_ = character_.share;
  const AxisPosition goal = goalOf(doing);
  reach_.begin(q_, qd_, goal, durationTo(goal));
  shape(doing);
  if (view_.fingers >= 0) fingers_ = q_[view_.fingers];
  if (view_.thumb >= 0) {
    thumb_ = q_[view_.thumb] - kThumbAlong * (fingers_ - kHalfBent);
  }
}

void BarPlayer::tremble(double period_s, AxisPosition& q, AxisVelocity& qd) noexcept {
  trembling_s_ += period_s;
  // Swells from nothing, so that the start is the start.
  const double swell = std::min(trembling_s_, 1.0), slope = trembling_s_ < 1.0 ? 1.0 : 0.0;
  for (int i = 0; i < q.size(); ++i) {
    const bool arm = i == view_.x || i == view_.y || i == view_.z;
    const double size = character_.tremor_m * (arm ? 1.0 : 10.0);
    const double phase = character_.tremor_phase + 1.7 * i + character_.tremor_rad_s * trembling_s_;
    q[i] += size * swell * std::sin(phase);
    qd[i] += size * (swell * character_.tremor_rad_s * std::cos(phase) + slope * std::sin(phase));
  }
}

// Fingers and thumb go by rates here; the arm rests.
void BarPlayer::press(double period_s) noexcept {
  if (view_.fingers < 0) return;
  // A large hand on a bottle is far from closed: a firm grip wants the fingers past their range.
  const double end = view_.upper[view_.fingers] + (grips_ ? kPastRange : 0.0);
  const double wanted =
      std::clamp(wanted_rate_, -(fingers_ - kHalfBent) / kGripEnd_s, (end - fingers_) / kGripEnd_s);
  rate_ += (wanted - rate_) * std::min(period_s / kGripFilter_s, 1.0);
  fingers_ += rate_ * period_s;
  q_[view_.fingers] = fingers_;
  qd_[view_.fingers] = rate_;
  if (view_.thumb < 0) return;
  q_[view_.thumb] = thumb_ + kThumbAlong * (fingers_ - kHalfBent);
  qd_[view_.thumb] = kThumbAlong * rate_;
}

}  // namespace wholehand
