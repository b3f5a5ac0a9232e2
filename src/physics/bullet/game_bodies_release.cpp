// What takes a body away from the hand: orders, silence, too much speed.
#include "core/body_order.hpp"
#include "physics/bullet/bullet_types.hpp"
#include "physics/bullet/game_bodies.hpp"

#include <algorithm>
#include <cmath>

namespace wholehand::bullet {
namespace {

// The arm follows the fading force: at 300 N/m it moves at 0.05 m/s.
constexpr double kLetGoRate_n_s = 15.0;
constexpr double kLeastLetGo_s = 0.1;

constexpr double kTargetLives_s = 0.1;
constexpr double kSilentFade_s = 0.2;
constexpr double kLeaves_s = 5.0;

// Faster, a body is held back and taken out: the supervisor stops the run when a body's speed rises
// by 10 m/s, or its spin by 500 rad/s, in one step.
constexpr double kMostSpeed_m_s = 4.9;
constexpr double kMostSpin_rad_s = 200.0;

}  // namespace

// At once when the hand does not press the body.
void GameBodies::letGo(int index, Then then) noexcept {
  Slot& slot = slots_[index];
  slot.then = then;
  if (slot.state == SlotState::kLettingGo) return;
  const double pressed_ns =
      slot.state == SlotState::kSolid ? solver_.impulseOn(first_ + index) : 0.0;
  if (!(pressed_ns > 0.0)) return carryOut(index);
  slot.state = SlotState::kLettingGo;
  slot.lasts_s = slot.left_s = std::max(kLeastLetGo_s, pressed_ns / step_s_ / kLetGoRate_n_s);
  slot.impulse_ns = pressed_ns;
  slot.solid_s = kFull_s;
  solver_.boundBody(first_ + index, pressed_ns);
}

void GameBodies::carryOut(int index) noexcept {
  Slot& slot = slots_[index];
  if (slot.then == Then::kPark) return park(index);
  if (slot.then == Then::kSetOwner) {
    slot.owner = slot.next_owner;
    slot.there = poseNow(index);
  }
  slot.velocity_m_s = slot.spin_rad_s = Vec3{};
  slot.target = slot.there;
  slot.target_age_s = 0.0;
  becomeGhost(index);
}

void GameBodies::fade(int index, double step_s) noexcept {
  Slot& slot = slots_[index];
  slot.left_s -= step_s;
  if (slot.left_s <= 0.5 * step_s) return carryOut(index);
  solver_.boundBody(first_ + index, slot.impulse_ns * slot.left_s / slot.lasts_s);
}

void GameBodies::finish(double step_s) noexcept {
  hand_touches_ = solver_.contactCount() > 0;
  watchSilence(step_s);
  held_j_ = 0.0;
  if (used_ == 0) return;
  received_j_ += 0.5 * step_s * (power_w_ + powerAndEnergy().first);
  for (int index = 0; index < count(); ++index) {
    Slot& slot = slots_[index];
    if (slot.state == SlotState::kParked) continue;
    const bool fresh = slot.target_age_s <= kTargetLives_s;
    slot.target_age_s += step_s;
    if (fresh && slot.target_age_s > kTargetLives_s) slot.target = poseNow(index);
    if (slot.state != SlotState::kGhost) holdWithin(index);
    if (slot.state == SlotState::kLettingGo) fade(index, step_s);
    if (slot.state == SlotState::kSolid && slot.solid_s < kFull_s) firm(index, step_s);
  }
  held_j_ = powerAndEnergy().second;
}

// A state that is not finite is left to observe(), and the run stops.
void GameBodies::holdWithin(int index) noexcept {
  btRigidBody& rigid = bodyOf(index).rigid();
  const double speed_m_s = rigid.getLinearVelocity().length();
  const double spin_rad_s = rigid.getAngularVelocity().length();
  const double far_m = rigid.getWorldTransform().getOrigin().length();
  if (!std::isfinite(speed_m_s) || !std::isfinite(spin_rad_s) || !std::isfinite(far_m)) return;
  rigid.setLinearVelocity(atMost(rigid.getLinearVelocity(), kMostSpeed_m_s));
  rigid.setAngularVelocity(atMost(rigid.getAngularVelocity(), kMostSpin_rad_s));
  if (speed_m_s <= kMostSpeed_m_s && far_m <= kFarthest_m) return;
  if (slots_[index].state == SlotState::kSolid) quarantined_ = index;
  letGo(index, Then::kPark);
}

void GameBodies::watchSilence(double step_s) noexcept {
  silent_s_ = alive_ ? 0.0 : silent_s_ + step_s;
  const double change = step_s / kSilentFade_s;
  force_share_ = std::clamp(force_share_ + (alive_ ? change : -change), 0.0, 1.0);
  if (silent_s_ <= kLeaves_s) return;
  for (int slot = 0; slot < count(); ++slot) {
    if (slots_[slot].state != SlotState::kParked) letGo(slot, Then::kPark);
  }
}

}  // namespace wholehand::bullet
