#include "exercise/cocktail_bar/bar_player.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace wholehand {
namespace {

constexpr double kDeg = std::numbers::pi / 180.0;

// Postures [rad]. Stretched, the fingers pass beside a dispenser; half bent, they pass in front of
// the row.
constexpr double kStretched = 8.0 * kDeg, kHalfBent = 65.0 * kDeg, kClosed = 155.0 * kDeg;
constexpr double kTurnedAside = 5.0 * kDeg, kOpposed = 20.0 * kDeg;
constexpr double kThumbClosed = 55.0 * kDeg;
constexpr double kThumbAlong = kThumbClosed / (kClosed - kHalfBent);  // with the fingers
constexpr double kBack_m = 0.006;                                     // before the end of x
constexpr double kDrawnBack_m = 0.001;                                // as good as there
constexpr double kBeside_m = 0.024;  // sideways from where the palm touches

// Peak speeds of a person at pace 1.
constexpr double kArm_m_s = 0.42, kFingers_rad_s = 4.0;
constexpr double kShortest_s = 0.3;

// Of the fingers' aim while they press.
constexpr double kClosing_rad_s = 1.5, kPressing_rad_s = 0.6;
constexpr double kGripFilter_s = 0.05;
constexpr double kGripEnd_s = 0.2;     // comes to rest at the end of the range in this time
constexpr int kMostTries = 4;          // squeezes of one grasp
constexpr double kGivesUp_s = 8.0;     // of a squeeze that comes to nothing
constexpr double kHoldShare = 0.5;     // of the zone's lower end: holds and does not pour
constexpr double kReleaseLag_s = 0.1;  // that a flow lasts on when the hand lets go
constexpr double kSettled_s = 0.3;     // a hold is trusted after this
constexpr double kNear_m = 0.06;       // to a dispenser: the hand is at it

}  // namespace

BarPlayer::BarPlayer(const BarView& view, std::uint64_t seed) : view_(view), seed_(seed) {
  BarPlayer::reset();
}

// splitmix64 (Steele, Lea and Flood 2014): the same on every machine.
double BarPlayer::draw() noexcept {
  random_ += 0x9E3779B97F4A7C15U;
  std::uint64_t z = random_;
  z = (z ^ (z >> 30U)) * 0xBF58476D1CE4E5B9U;
  z = (z ^ (z >> 27U)) * 0x94D049BB133111EBU;
  return static_cast<double>((z ^ (z >> 31U)) >> 11U) * 0x1.0p-53;
}

double BarPlayer::draw(double low, double high) noexcept {
  return low + (high - low) * draw();
}

void BarPlayer::reset() {
  random_ = seed_;
  character_.reaction_s = draw(0.15, 0.28);
  character_.pace = draw(0.8, 1.2);
  character_.share = draw(0.3, 0.7);
  character_.aim_m = draw(0.001, 0.004);
  character_.judgement = draw(0.4, 1.6);
  character_.tremor_m = draw(0.0, 0.0003);
  character_.tremor_rad_s = 2.0 * std::numbers::pi * draw(7.0, 11.0);
  character_.tremor_phase = draw(0.0, 2.0 * std::numbers::pi);
  start_ = AxisPosition(view_.axes);
  const auto put = [this](int axis, double value) {
    if (axis >= 0) start_[axis] = std::clamp(value, view_.lower[axis], view_.upper[axis]);
  };
  put(view_.x, draw(-0.08, -0.06));
  put(view_.y, draw(-0.1, 0.08));
  put(view_.z, draw(-0.03, 0.03));
  put(view_.fingers, draw(40.0, 80.0) * kDeg);
  put(view_.turn, draw(2.0, 8.0) * kDeg);
  q_ = start_;
  qd_ = AxisVelocity(view_.axes);
  lost_ = advanced_ = false;
  dispenser_ = drink_ = step_ = -1;
  tries_ = 0;
  lifted_ = false;
  rate_ = wanted_rate_ = trembling_s_ = glance_due_s_ = 0.0;
  remembered_ = newest_ = 0;
  memory_.fill({});
  go(Doing::kWait);
}

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
  settled_s_ = 0.0;
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

void BarPlayer::advance(double period_s, AxisPosition& q, AxisVelocity& qd) noexcept {
  advanced_ = true;
  period_s_ = period_s;
  since_s_ += period_s;
  if (lost_) {
    lost_ = false;
    go(near_ ? Doing::kOpen : Doing::kDrawBack);
  }
  reach_.advance(period_s, q_, qd_);
  if (doing_ == Doing::kSqueeze || doing_ == Doing::kEase) press(period_s);
  q = q_;
  qd = qd_;
  tremble(period_s, q, qd);
}

// Fingers and thumb go by rates here; the arm rests.
void BarPlayer::press(double period_s) noexcept {
  if (view_.fingers < 0) return;
  const double upper = view_.upper[view_.fingers];
  const double wanted = std::clamp(wanted_rate_, -(fingers_ - kHalfBent) / kGripEnd_s,
                                   (upper - fingers_) / kGripEnd_s);
  rate_ += (wanted - rate_) * std::min(period_s / kGripFilter_s, 1.0);
  fingers_ += rate_ * period_s;
  q_[view_.fingers] = fingers_;
  qd_[view_.fingers] = rate_;
  if (view_.thumb < 0) return;
  q_[view_.thumb] = thumb_ + kThumbAlong * (fingers_ - kHalfBent);
  qd_[view_.thumb] = kThumbAlong * rate_;
}

void BarPlayer::see(const TickRecord& record) noexcept {
  if (!advanced_ && record.intention.size() == view_.axes) {
    lost_ = true;
    q_ = record.intention;
    qd_ = AxisVelocity(view_.axes);
    near_ = comeNear(record);
  }
  advanced_ = false;
  glance_due_s_ -= period_s_ * record.elapsed_periods;
  if (glance_due_s_ < 0.5 * period_s_) {
    glance_due_s_ += kGlance_s;
    newest_ = (newest_ + 1) % kMemory;
    memory_[static_cast<std::size_t>(newest_)] = glance(record.exercise);
    remembered_ = std::min(remembered_ + 1, kMemory);
  }
  if (!lost_) decide(remember(), record);
}

/// What was to be seen a reaction time ago.
const BarGlance& BarPlayer::remember() const noexcept {
  const int ago = std::min(static_cast<int>(character_.reaction_s / kGlance_s), remembered_ - 1);
  return memory_[static_cast<std::size_t>((newest_ - ago + kMemory) % kMemory)];
}

bool BarPlayer::wantsToGrasp(const BarGlance& seen) const noexcept {
  return (seen.stage == BarStage::kReach || seen.stage == BarStage::kSqueeze ||
          seen.stage == BarStage::kPouring) &&
         seen.target >= 0 && seen.target < view_.dispenser_count;
}

void BarPlayer::aimAt(const TickRecord& record, int dispenser) noexcept {
  dispenser_ = dispenser;
  const BarView::Dispenser& d = view_.dispensers[static_cast<std::size_t>(dispenser)];
  const BodyState& body = record.bodies[static_cast<std::size_t>(std::max(d.body, 0))];
  const double off = character_.aim_m;
  grip_ = worldPoint(body, d.grip_m) - view_.grip_m +
          Eigen::Vector3d(draw(-off, off), draw(-off, off), draw(-off, off));
  over_ = grip_;
  if (!d.free || view_.glass_body < 0) return;
  const Eigen::Vector3d glass =
      record.bodies[static_cast<std::size_t>(view_.glass_body)].position_m.eigen();
  const Eigen::Vector3d nozzle = worldPoint(body, d.nozzle_m);
  over_ += Eigen::Vector3d(glass.x() - nozzle.x(), glass.y() - nozzle.y(),
                           std::max(0.02, glass.z() + view_.glass_top_m + 0.02 - nozzle.z()));
}

/// Takes up with the dispenser that the hand is at; false where it is at none.
bool BarPlayer::comeNear(const TickRecord& record) noexcept {
  for (int i = 0; i < view_.dispenser_count; ++i) {
    aimAt(record, i);
    double apart_m = 0.0;
    for (const auto& [axis, at] : {std::pair{view_.x, grip_.x()}, {view_.y, grip_.y()}}) {
      if (axis >= 0) apart_m = std::max(apart_m, std::abs(q_[axis] - at));
    }
    if (apart_m < kNear_m) return true;
  }
  dispenser_ = -1;
  return false;
}

void BarPlayer::decide(const BarGlance& seen, const TickRecord& record) noexcept {
  const bool wants = wantsToGrasp(seen);
  const bool same = wants && seen.target == dispenser_;
  switch (doing_) {
    case Doing::kWait:
      if (since_s_ < character_.reaction_s) return;
      if (seen.stage == BarStage::kDrawBack && !drawnBack()) go(Doing::kDrawBack);
      if (!wants) return;
      aimAt(record, seen.target);
      drink_ = seen.drink;
      step_ = seen.step;
      tries_ = 0;
      go(Doing::kAlign);
      return;
    case Doing::kSqueeze:
    case Doing::kEase:
      pressBy(seen);
      return;
    case Doing::kAlign:
    case Doing::kEnter:
      if (!same) {
        go(Doing::kDrawBack);
        return;
      }
      break;
    default:
      break;
  }
  if (reach_.done()) next(seen);
}

void BarPlayer::next(const BarGlance& seen) noexcept {
  const bool free = dispenser_ >= 0 && view_.dispensers[static_cast<std::size_t>(dispenser_)].free;
  const bool more =
      wantsToGrasp(seen) && seen.target == dispenser_ && seen.step == step_ && seen.drink == drink_;
  switch (doing_) {
    case Doing::kAlign:
      return go(Doing::kEnter);
    case Doing::kEnter:
      return go(Doing::kTouch);
    case Doing::kTouch:
      lifted_ = false;
      return go(Doing::kSqueeze);
    case Doing::kLift:
      return go(Doing::kCarry);
    case Doing::kCarry:
      lifted_ = true;
      return go(Doing::kSqueeze);
    case Doing::kReturn:
      return go(Doing::kLower);
    case Doing::kLower:
      lifted_ = false;
      return go(Doing::kOpen);
    case Doing::kOpen:
      // Too little yet: once more from here. A grasp that came to nothing is begun anew.
      if (more && !free && tries_ < kMostTries) return go(Doing::kSqueeze);
      return go(dispenser_ >= 0 ? Doing::kLeave : Doing::kDrawBack);
    case Doing::kLeave:
      return go(Doing::kDrawBack);
    case Doing::kDrawBack:
      return go(Doing::kWait);
    default:
      return;
  }
}

void BarPlayer::pressBy(const BarGlance& seen) noexcept {
  const bool free = dispenser_ >= 0 && view_.dispensers[static_cast<std::size_t>(dispenser_)].free;
  const bool hold = free && (!lifted_ || doing_ == Doing::kEase);
  const double zone_n = seen.low_n + share_ * (seen.high_n - seen.low_n);
  const double wanted_n = std::max(hold ? kHoldShare * seen.low_n : zone_n, 0.5);
  if (seen.squeeze_n < 0.15 * wanted_n) {
    wanted_rate_ = kClosing_rad_s * character_.pace;
  } else {
    const double missing = (wanted_n - seen.squeeze_n) / wanted_n;
    wanted_rate_ = std::clamp(kPressing_rad_s * missing, -kPressing_rad_s, kPressing_rad_s);
  }
  if (hold) {
    const bool held = std::abs(seen.squeeze_n - wanted_n) < 0.3 * wanted_n;
    settled_s_ = held ? settled_s_ + period_s_ : 0.0;
    if (settled_s_ > kSettled_s) return go(doing_ == Doing::kEase ? Doing::kReturn : Doing::kLift);
    if (since_s_ > kGivesUp_s) return go(lifted_ ? Doing::kReturn : Doing::kOpen);
    return;
  }
  const bool pouring = wantsToGrasp(seen) || seen.stage == BarStage::kLetGo;  // not yet the line
  const bool other =
      !pouring || seen.target != dispenser_ || seen.step != step_ || seen.drink != drink_;
  const double coming_l =
      character_.judgement * seen.flow_l_s * (character_.reaction_s + kReleaseLag_s);
  const bool enough = seen.asked_l > 0.0 && seen.poured_l + coming_l >= seen.asked_l;
  const bool wrong = seen.engaged >= 0 && seen.engaged != dispenser_;
  if (since_s_ > kGivesUp_s && seen.flow_l_s == 0.0) tries_ = kMostTries;
  if ((other && since_s_ > character_.reaction_s) || enough || wrong || tries_ == kMostTries) {
    share_ *= 0.5;  // what is missing afterwards is poured with less
    ++tries_;
    go(free ? Doing::kEase : Doing::kOpen);
  }
}

std::unique_ptr<Player> makeBarPlayer(const Bar& bar, const DeviceModel& device,
                                      const HandModel* hand, std::uint64_t seed) {
  return std::make_unique<BarPlayer>(makeBarView(bar, device, hand), seed);
}

std::unique_ptr<Player> makeBarPlayer(const Bar& bar, const ExerciseDescription&,
                                      const DeviceModel& device, std::uint64_t seed) {
  return makeBarPlayer(bar, device, nullptr, seed);
}

}  // namespace wholehand
