#include "exercises/cocktail_bar/bar_player.hpp"

#include "exercises/approach.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

// Movements of the player's hand.
namespace wholehand {
namespace {

// Speeds of the fingers' target while pressing.
constexpr double kClosing_rad_s = 0.9, kPressing_rad_s = 0.6;
constexpr int kMostTries = 4;           // most squeezes per grasp
constexpr double kGivesUp_s = 8.0;      // the player gives up a squeeze after this time without ...
constexpr double kWorthwhile_l = 2e-3;  // ... this volume into the glass
constexpr double kFartherOff_m = 2e-3;  // growth of the aiming error with every failed grasp ...
constexpr double kFarthestOff_m = 0.012;  // ... at most
// Share of the zone's lower end at which the hand holds without pouring.
constexpr double kHoldShare = 0.82;
constexpr double kHeld = 0.08;          // relative tolerance of a hold
constexpr double kReleaseLag_s = 0.1;   // time for which a flow continues after the release ...
constexpr double kEaseLag_s = 1.1;      // ... and after easing the grip
constexpr double kSettled_s = 0.3;      // a hold is stable after this time
constexpr double kSlowerAtFirst = 2.0;  // duration factor of the first motion after others led
constexpr double kNear_m = 0.06;        // the hand counts as at a dispenser within this distance

using namespace approach;

constexpr double kDrawnBack_m = 0.001;  // tolerance of a withdrawn hand
constexpr double kHeldBack_m = 0.01;    // a hand farther than this from its withdrawn position ...
constexpr double kHeldBack_s = 1.0;     // ... after this time is blocked by something

// Motion of the fingers' target while pressing.
constexpr double kGripFilter_s = 0.05;
constexpr double kPastRange = 30.0 * kDeg;  // target beyond the range during a grip
constexpr double kGripEnd_s = 0.2;          // time to come to rest at the end of the range

}  // namespace

BarPlayer::BarPlayer(const BarLayout& layout, const PlayerTraits& traits)
    : ReachingPlayer(layout), bar_(layout), traits_(traits) {
  BarPlayer::reset();
}

// splitmix64 (Steele, Lea and Flood 2014): same on every machine.
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
  random_ = traits_.seed;
  character_.reaction_s = draw(0.15, 0.28);
  character_.pace = draw(0.8, 1.2);
  character_.share = draw(0.3, 0.7);
  character_.aim_m = draw(0.001, 0.004);
  character_.judgement = draw(0.4, 1.6);
  character_.tremor_m = draw(0.0, 0.0003);
  character_.tremor_rad_s = 2.0 * std::numbers::pi * draw(7.0, 11.0);
  character_.tremor_phase = draw(0.0, 2.0 * std::numbers::pi);
  const auto put = [this](int axis, double value) {
    if (axis >= 0) start_[axis] = std::clamp(value, hand_.lower[axis], hand_.upper[axis]);
  };
  put(hand_.x, draw(-0.08, -0.06));
  put(hand_.y, draw(-0.1, 0.08));
  put(hand_.z, draw(-0.03, 0.03));
  // The tips of a long hand must start before the dispensers.
  const double least = 40.0 + 200.0 * std::max(hand_.scale - 1.11, 0.0);
  put(hand_.fingers, draw(least, 80.0) * kDeg);
  put(hand_.turn, draw(2.0, 8.0) * kDeg);
  toStart();
  measured_ = start_;
  dispenser_ = drink_ = step_ = -1;
  tries_ = failures_ = 0;
  poured_before_l_ = poured_l_ = stalled_s_ = 0.0;
  lifted_ = false;
  rate_ = wanted_rate_ = trembling_s_ = look_due_s_ = 0.0;
  grips_ = false;
  remembered_ = newest_ = 0;
  memory_.fill({});
  go(Phase::kWait);
}

void BarPlayer::advance(double period_s, AxisPosition& q, AxisVelocity& qd) noexcept {
  period_s_ = period_s;
  since_s_ += period_s;
  if (takesOver()) {
    go(near_ ? Phase::kOpen : touches_ ? Phase::kFree : Phase::kDrawBack, kSlowerAtFirst);
  }
  reach_.advance(period_s, q_, qd_);
  if (phase_ == Phase::kSqueeze || phase_ == Phase::kEase) press(period_s);
  q = q_;
  qd = qd_;
  tremble(period_s, q, qd);
}

void BarPlayer::onRecord(const TickRecord& record) noexcept {
  if (steeredByOthers(record)) {
    near_ = comeNear(record);
    touches_ = record.contact_count > 0;
  }
  if (record.q_m.size() == hand_.axes) measured_ = record.q_m;
  look_due_s_ -= period_s_ * record.elapsed_periods;
  if (look_due_s_ < 0.5 * period_s_) {
    look_due_s_ += kLook_s;
    newest_ = (newest_ + 1) % kMemory;
    memory_[newest_] = readBarStatus(record.exercise);
    remembered_ = std::min(remembered_ + 1, kMemory);
  }
  if (!lost_) decide(remember(), record);
}

/// The status of one reaction time ago.
const BarStatus& BarPlayer::remember() const noexcept {
  const int ago = std::min(static_cast<int>(character_.reaction_s / kLook_s), remembered_ - 1);
  return memory_[(newest_ - ago + kMemory) % kMemory];
}

bool BarPlayer::wantsToGrasp(const BarStatus& seen) const noexcept {
  return (seen.stage == BarStage::kReach || seen.stage == BarStage::kSqueeze ||
          seen.stage == BarStage::kPouring || seen.stage == BarStage::kBreathe) &&
         seen.target >= 0 && seen.target < bar_.dispenser_count;
}

void BarPlayer::aimAt(const TickRecord& record, int dispenser) noexcept {
  dispenser_ = dispenser;
  const BarLayout::Dispenser& d = bar_.dispensers[dispenser];
  const BodyState& body = record.bodies[std::max(d.body, 0)];
  const double off = std::min(character_.aim_m + kFartherOff_m * failures_, kFarthestOff_m);
  grip_ = worldPoint(body, d.grip_m) - hand_.grip_m +
          Eigen::Vector3d(draw(-off, off), draw(-off, off), draw(-off, off));
  over_ = grip_;
  if (!d.free || bar_.glass_body < 0) return;
  const Eigen::Vector3d glass = record.bodies[bar_.glass_body].position_m.eigen();
  const Eigen::Vector3d nozzle = worldPoint(body, d.nozzle_m);
  over_ += Eigen::Vector3d(glass.x() - nozzle.x(), glass.y() - nozzle.y(),
                           std::max(0.02, glass.z() + bar_.glass_top_m + 0.02 - nozzle.z()));
}

/// Aims the nozzle over the glass at its actual position, because a lifted dispenser may lean in
/// the hand.
void BarPlayer::aimOverGlass(const TickRecord& record) noexcept {
  const BarLayout::Dispenser& d = bar_.dispensers[dispenser_];
  const auto state_of = [&record](int body) -> const BodyState& {
    return record.bodies[std::max(body, 0)];
  };
  const Eigen::Vector3d off =
      state_of(bar_.glass_body).position_m.eigen() - worldPoint(state_of(d.body), d.nozzle_m);
  if (hand_.x >= 0) over_.x() = q_[hand_.x] + off.x();
  if (hand_.y >= 0) over_.y() = q_[hand_.y] + off.y();
}

/// Continues with the dispenser near the hand; false if there is none.
bool BarPlayer::comeNear(const TickRecord& record) noexcept {
  for (int i = 0; i < bar_.dispenser_count; ++i) {
    aimAt(record, i);
    double apart_m = 0.0;
    for (const auto& [axis, at] : {std::pair{hand_.x, grip_.x()}, {hand_.y, grip_.y()}}) {
      if (axis >= 0) apart_m = std::max(apart_m, std::abs(q_[axis] - at));
    }
    if (apart_m < kNear_m) return true;
  }
  dispenser_ = -1;
  return false;
}

/// Updates the count of failed grasps at the beginning of a new grasp.
void BarPlayer::countFailedGrasp(const BarStatus& seen) noexcept {
  const bool again = seen.drink == drink_ && seen.step == step_;
  const bool failed = again && seen.poured_l - poured_before_l_ < kWorthwhile_l;
  failures_ = failed ? failures_ + 1 : 0;
  poured_before_l_ = seen.poured_l;
}

void BarPlayer::decide(const BarStatus& seen, const TickRecord& record) noexcept {
  const bool wants = wantsToGrasp(seen);
  const bool same = wants && seen.target == dispenser_;
  switch (phase_) {
    case Phase::kWait:
      if (since_s_ < character_.reaction_s) return;
      if (seen.stage == BarStage::kDrawBack && !drawnBack()) go(Phase::kDrawBack);
      if (seen.stage == BarStage::kDrawBack && isHeldBack()) go(Phase::kFree);
      if (!wants) return;
      countFailedGrasp(seen);
      aimAt(record, seen.target);
      drink_ = seen.drink;
      step_ = seen.step;
      tries_ = 0;
      go(Phase::kAlign);
      return;
    case Phase::kSqueeze:
    case Phase::kEase:
      pressBy(seen);
      return;
    case Phase::kAlign:
    case Phase::kEnter:
      if (!same) {
        go(Phase::kDrawBack);
        return;
      }
      break;
    default:
      break;
  }
  if (reach_.done()) next(seen, record);
}

void BarPlayer::next(const BarStatus& seen, const TickRecord& record) noexcept {
  const bool free = dispenser_ >= 0 && bar_.dispensers[dispenser_].free;
  const bool more =
      wantsToGrasp(seen) && seen.target == dispenser_ && seen.step == step_ && seen.drink == drink_;
  switch (phase_) {
    case Phase::kAlign:
      return go(Phase::kEnter);
    case Phase::kEnter:
      return go(Phase::kTouch);
    case Phase::kTouch:
      lifted_ = false;
      return go(Phase::kSqueeze);
    case Phase::kLift:
      aimOverGlass(record);
      return go(Phase::kCarry);
    case Phase::kCarry:
      lifted_ = true;
      return go(Phase::kSqueeze);
    case Phase::kReturn:
      return go(Phase::kLower);
    case Phase::kLower:
      lifted_ = false;
      return go(Phase::kOpen);
    case Phase::kOpen:
      // Too little was poured: the hand squeezes again without a new grasp. A failed grasp starts
      // again.
      if (more && !free && seen.stage == BarStage::kBreathe) {
        if (since_s_ < kGivesUp_s) return;
        tries_ = kMostTries;  // the hand does not open far enough
      }
      if (more && !free && tries_ < kMostTries) return go(Phase::kSqueeze);
      return go(dispenser_ >= 0 ? Phase::kLeave : Phase::kDrawBack);
    case Phase::kLeave:
    case Phase::kFree:
      return go(Phase::kDrawBack);
    case Phase::kDrawBack:
      return go(Phase::kWait);
    default:
      return;
  }
}

void BarPlayer::pressBy(const BarStatus& seen) noexcept {
  const bool free = dispenser_ >= 0 && bar_.dispensers[dispenser_].free;
  const bool hold = free && (!lifted_ || phase_ == Phase::kEase);
  const double zone_n = seen.low_n + share_ * (seen.high_n - seen.low_n);
  const double wanted_n = std::max(hold ? kHoldShare * seen.low_n : zone_n, 0.5);
  grips_ = seen.squeeze_n >= 0.15 * wanted_n;
  if (!grips_) {
    wanted_rate_ = kClosing_rad_s * character_.pace;
  } else {
    const double missing = (wanted_n - seen.squeeze_n) / wanted_n;
    wanted_rate_ = std::clamp(kPressing_rad_s * missing, -kPressing_rad_s, kPressing_rad_s);
  }
  if (hold) {
    const bool held = std::abs(seen.squeeze_n - wanted_n) < kHeld * wanted_n;
    settled_s_ = held ? settled_s_ + period_s_ : 0.0;
    if (settled_s_ > kSettled_s) return go(phase_ == Phase::kEase ? Phase::kReturn : Phase::kLift);
    if (since_s_ > kGivesUp_s) return go(lifted_ ? Phase::kReturn : Phase::kOpen);
    return;
  }
  // The line is not reached yet.
  const bool pouring = wantsToGrasp(seen) || seen.stage == BarStage::kLetGo;
  const bool other =
      !pouring || seen.target != dispenser_ || seen.step != step_ || seen.drink != drink_;
  const double lag_s = character_.reaction_s + (free ? kEaseLag_s : kReleaseLag_s);
  const double coming_l = character_.judgement * seen.flow_l_s * lag_s;
  const bool enough = seen.asked_l > 0.0 && seen.poured_l + coming_l >= seen.asked_l;
  // A spent stroke is not a failed try: air flows back in, and the hand squeezes again.
  if (seen.stage == BarStage::kBreathe && since_s_ > character_.reaction_s) {
    return go(free ? Phase::kEase : Phase::kOpen);
  }
  const bool wrong = seen.engaged >= 0 && seen.engaged != dispenser_;
  const bool worthwhile = std::abs(seen.poured_l - poured_l_) > kWorthwhile_l;
  stalled_s_ = worthwhile ? 0.0 : stalled_s_ + period_s_;
  if (worthwhile) poured_l_ = seen.poured_l;
  if (stalled_s_ > kGivesUp_s) tries_ = kMostTries;
  if ((other && since_s_ > character_.reaction_s) || enough || wrong || tries_ == kMostTries) {
    share_ *= 0.5;  // pours the rest with less force
    ++tries_;
    go(free ? Phase::kEase : Phase::kOpen);
  }
}

std::unique_ptr<Player> makeBarPlayer(const Bar& bar, const DeviceModel& device,
                                      const HandModel* hand, const PlayerTraits& traits) {
  return std::make_unique<BarPlayer>(makeBarLayout(bar, device, hand), traits);
}

bool BarPlayer::drawnBack() const noexcept {
  return hand_.x < 0 || q_[hand_.x] < back_m(hand_) + kDrawnBack_m;
}

/// True when something blocks the withdrawal. A hand between two dispensers is clamped by the force
/// that pulls it sideways.
bool BarPlayer::isHeldBack() const noexcept {
  return hand_.x >= 0 && since_s_ > kHeldBack_s && measured_[hand_.x] > back_m(hand_) + kHeldBack_m;
}

AxisPosition BarPlayer::goalOf(Phase phase) const noexcept {
  Goal goal(hand_, q_);
  const Eigen::Vector3d beside = grip_ - Eigen::Vector3d(0.0, hand_.beside * kBeside_m, 0.0);
  switch (phase) {
    case Phase::kDrawBack:
      return goal.drawBack();
    case Phase::kFree:
      for (const int axis : {hand_.y, hand_.z}) {
        goal.put(axis, measured_[axis]);
      }
      goal.put(hand_.x, back_m(hand_));
      return goal.hand(kStretched, kTurnedAside);
    case Phase::kAlign:
      return goal.pose({back_m(hand_), beside.y(), beside.z()}, kHalfBent, kTurnedAside);
    case Phase::kEnter:
    case Phase::kLeave:
      return goal.pose(beside, kStretched, kTurnedAside);
    case Phase::kTouch:
      return goal.pose(grip_, kHalfBent, kOpposed);
    case Phase::kOpen:
      return goal.hand(kHalfBent, kTurnedAside);
    case Phase::kLift:
      return goal.put(hand_.z, over_.z());
    case Phase::kCarry:
      return goal.base(over_);
    case Phase::kReturn:
      return goal.base({grip_.x(), grip_.y(), over_.z()});
    case Phase::kLower:
      return goal.base(grip_);
    case Phase::kWait:
    case Phase::kSqueeze:
    case Phase::kEase:
      break;
  }
  return goal.at();
}

// Sets the timing of the axes so that the fingers pass beside dispensers and not through them.
void BarPlayer::shape(Phase phase) noexcept {
  const auto during = [this](int axis, double from, double to) {
    if (axis >= 0) reach_.during(axis, from, to);
  };
  if (phase == Phase::kEnter) {
    during(hand_.fingers, 0.0, 0.45);
    during(hand_.x, 0.3, 1.0);
  } else if (phase == Phase::kTouch) {
    during(hand_.y, 0.0, 0.7);
    during(hand_.fingers, 0.2, 1.0);
    during(hand_.turn, 0.3, 1.0);
  } else if (phase == Phase::kLeave) {
    during(hand_.y, 0.0, 0.7);
    during(hand_.fingers, 0.2, 1.0);
  } else if (phase == Phase::kDrawBack) {
    during(hand_.x, 0.0, 0.75);
    during(hand_.fingers, 0.5, 1.0);
  } else if (phase == Phase::kFree) {
    during(hand_.fingers, 0.0, 0.5);
    during(hand_.x, 0.4, 1.0);
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
  reach_.begin(q_, qd_, goal, slower * (durationTo(hand_, q_, goal) / character_.pace));
  shape(phase);
  limitOpening(hand_, q_, traits_.opening_rad_s, reach_);
  if (hand_.fingers >= 0) fingers_ = q_[hand_.fingers];
  if (hand_.thumb >= 0) {
    thumb_ = q_[hand_.thumb] - kThumbAlong * (fingers_ - kHalfBent);
  }
}

void BarPlayer::tremble(double period_s, AxisPosition& q, AxisVelocity& qd) noexcept {
  trembling_s_ += period_s;
  // The tremor fades in, so that the motion starts at the start pose.
  const double swell = std::min(trembling_s_, 1.0), slope = trembling_s_ < 1.0 ? 1.0 : 0.0;
  for (int i = 0; i < q.size(); ++i) {
    const bool arm = i == hand_.x || i == hand_.y || i == hand_.z;
    const double size = character_.tremor_m * (arm ? 1.0 : 10.0);
    const double phase = character_.tremor_phase + 1.7 * i + character_.tremor_rad_s * trembling_s_;
    q[i] += size * swell * std::sin(phase);
    qd[i] += size * (swell * character_.tremor_rad_s * std::cos(phase) + slope * std::sin(phase));
  }
}

// Moves fingers and thumb with rates while the arm rests.
void BarPlayer::press(double period_s) noexcept {
  if (hand_.fingers < 0) return;
  // A large hand around a bottle is far from closed, so that a firm grip needs a target beyond the
  // fingers' range.
  const double end = hand_.upper[hand_.fingers] + (grips_ ? kPastRange : 0.0);
  const double wanted =
      std::clamp(wanted_rate_, -(fingers_ - kHalfBent) / kGripEnd_s, (end - fingers_) / kGripEnd_s);
  rate_ += (wanted - rate_) * std::min(period_s / kGripFilter_s, 1.0);
  fingers_ += rate_ * period_s;
  q_[hand_.fingers] = fingers_;
  qd_[hand_.fingers] = rate_;
  if (hand_.thumb < 0) return;
  q_[hand_.thumb] = thumb_ + kThumbAlong * (fingers_ - kHalfBent);
  qd_[hand_.thumb] = kThumbAlong * rate_;
}

}  // namespace wholehand
