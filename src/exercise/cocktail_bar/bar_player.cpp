#include "exercise/cocktail_bar/bar_player.hpp"

#include "core/units.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace wholehand {
namespace {

// Of the fingers' aim while they press.
constexpr double kClosing_rad_s = 1.5, kPressing_rad_s = 0.6;
constexpr int kMostTries = 4;             // squeezes of one grasp
constexpr double kGivesUp_s = 8.0;        // of a squeeze that in this time does not bring ...
constexpr double kWorthwhile_l = 2e-3;    // ... so much into the glass
constexpr double kFartherOff_m = 2e-3;    // an aim, with every grasp that failed ...
constexpr double kFarthestOff_m = 0.012;  // ... at most
constexpr double kHoldShare = 0.82;       // of the zone's lower end: holds and does not pour
constexpr double kHeld = 0.08;            // as a share: as it should be
constexpr double kReleaseLag_s = 0.1;     // that a flow lasts on when the hand lets go
constexpr double kEaseLag_s = 0.5;        // and when it only eases its grip
constexpr double kSettled_s = 0.3;        // a hold is trusted after this
constexpr double kNear_m = 0.06;          // to a dispenser: the hand is at it

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
  tries_ = failures_ = 0;
  poured_before_l_ = poured_l_ = vain_s_ = 0.0;
  lifted_ = false;
  rate_ = wanted_rate_ = trembling_s_ = glance_due_s_ = 0.0;
  grips_ = false;
  remembered_ = newest_ = 0;
  memory_.fill({});
  go(Doing::kWait);
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
  const double off = std::min(character_.aim_m + kFartherOff_m * failures_, kFarthestOff_m);
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

/// A dispenser that is lifted may lean in the hand: where its nozzle is now, is to be over the
/// glass.
void BarPlayer::aimOverGlass(const TickRecord& record) noexcept {
  const BarView::Dispenser& d = view_.dispensers[static_cast<std::size_t>(dispenser_)];
  const auto state_of = [&record](int body) -> const BodyState& {
    return record.bodies[static_cast<std::size_t>(std::max(body, 0))];
  };
  const Eigen::Vector3d off =
      state_of(view_.glass_body).position_m.eigen() - worldPoint(state_of(d.body), d.nozzle_m);
  if (view_.x >= 0) over_.x() = q_[view_.x] + off.x();
  if (view_.y >= 0) over_.y() = q_[view_.y] + off.y();
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

/// Another grasp begins: did the one before bring anything?
void BarPlayer::noteGrasp(const BarGlance& seen) noexcept {
  const bool again = seen.drink == drink_ && seen.step == step_;
  const bool failed = again && seen.poured_l - poured_before_l_ < kWorthwhile_l;
  failures_ = failed ? failures_ + 1 : 0;
  poured_before_l_ = seen.poured_l;
}

void BarPlayer::decide(const BarGlance& seen, const TickRecord& record) noexcept {
  const bool wants = wantsToGrasp(seen);
  const bool same = wants && seen.target == dispenser_;
  switch (doing_) {
    case Doing::kWait:
      if (since_s_ < character_.reaction_s) return;
      if (seen.stage == BarStage::kDrawBack && !drawnBack()) go(Doing::kDrawBack);
      if (!wants) return;
      noteGrasp(seen);
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
  if (reach_.done()) next(seen, record);
}

void BarPlayer::next(const BarGlance& seen, const TickRecord& record) noexcept {
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
      aimOverGlass(record);
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
    if (settled_s_ > kSettled_s) return go(doing_ == Doing::kEase ? Doing::kReturn : Doing::kLift);
    if (since_s_ > kGivesUp_s) return go(lifted_ ? Doing::kReturn : Doing::kOpen);
    return;
  }
  const bool pouring = wantsToGrasp(seen) || seen.stage == BarStage::kLetGo;  // not yet the line
  const bool other =
      !pouring || seen.target != dispenser_ || seen.step != step_ || seen.drink != drink_;
  const double lag_s = character_.reaction_s + (free ? kEaseLag_s : kReleaseLag_s);
  const double coming_l = character_.judgement * seen.flow_l_s * lag_s;
  const bool enough = seen.asked_l > 0.0 && seen.poured_l + coming_l >= seen.asked_l;
  const bool wrong = seen.engaged >= 0 && seen.engaged != dispenser_;
  const bool worthwhile = std::abs(seen.poured_l - poured_l_) > kWorthwhile_l;
  vain_s_ = worthwhile ? 0.0 : vain_s_ + period_s_;
  if (worthwhile) poured_l_ = seen.poured_l;
  if (vain_s_ > kGivesUp_s) tries_ = kMostTries;
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

}  // namespace wholehand
