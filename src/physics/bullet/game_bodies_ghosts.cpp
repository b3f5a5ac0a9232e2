// Ghosts: bodies that have a pose, and become solid where they overlap nothing.
#include "physics/bullet/bullet_types.hpp"
#include "physics/bullet/game_bodies.hpp"

#include <algorithm>
#include <cmath>

namespace wholehand::bullet {
namespace {

// Bound of the normal forces between the hand and a body together. Without it, a hand that wedges
// between two fixed bodies was seen to be pressed with 33 kN from both sides. After an overlap the
// bound begins with kFirst_n and grows by the factor e in kGrow_s.
constexpr double kMostContact_n = 100.0;
constexpr double kFirst_n = 0.5;
constexpr double kGrow_s = 0.03;

}  // namespace

// At slot.there. Everything that rested on it, or where it appears, wakes.
void GameBodies::becomeGhost(int index) noexcept {
  Slot& slot = slots_[index];
  const int body = first_ + index;
  if (slot.state == SlotState::kGhost) --ghosts_;
  slot.state = SlotState::kGhost;
  ++ghosts_;
  ++version_;
  solver_.unboundBody(body);
  const ShapeSets::Set& set = *sets_.find(slot.shape_set);
  bodyOf(index).setMass(slot.owner == BodyOwner::kFixed ? 0.0 : slot.mass_kg, set.moments_per_kg,
                        slot.friction,
                        slot.owner == BodyOwner::kLoop ? gravity_ : btVector3(0, 0, 0));
  resting_.setMoves(body, true);
  bodyOf(index).putAt(slot.there, {});
  pairs_.placed(body);
  pairs_.forget(body);
}

void GameBodies::becomeSolid(int index) noexcept {
  Slot& slot = slots_[index];
  const int body = first_ + index;
  slot.state = SlotState::kSolid;
  ++slot.solid_count;
  slot.refuse_overlap = false;
  slot.solid_s = slot.overlapped ? 0.0 : kFull_s;
  slot.overlapped = false;
  solver_.boundBody(body, (slot.solid_s < kFull_s ? kFirst_n : kMostContact_n) * step_s_);
  --ghosts_;
  ++version_;
  if (slot.owner == BodyOwner::kLoop) {
    bodies_[body].rigid().setLinearVelocity(toBt(slot.velocity_m_s.eigen()));
    bodies_[body].rigid().setAngularVelocity(toBt(slot.spin_rad_s.eigen()));
  }
  pairs_.forget(body);  // its points were never solved
  if (slot.owner == BodyOwner::kFixed) resting_.setMoves(body, false);
}

void GameBodies::firm(int index, double step_s) noexcept {
  Slot& slot = slots_[index];
  slot.solid_s += step_s;
  const double grown_n = kFirst_n * std::exp(slot.solid_s / kGrow_s);
  solver_.boundBody(first_ + index, std::min(grown_n, kMostContact_n) * step_s);
}

// Of two ghosts the lower slot goes first, so that they do not wait for one another.
void GameBodies::noteOverlap(const ColliderTag& of, const ColliderTag& with) noexcept {
  if (of.ofHand() || !isGhost(of.body)) return;
  if (!with.ofHand() && isGhost(with.body) && with.body > of.body) return;
  overlaps_[of.body - first_] = true;
}

void GameBodies::findOverlaps() noexcept {
  overlaps_.fill(false);
  for (int m = 0; m < dispatcher_.getNumManifolds(); ++m) {
    const btPersistentManifold& manifold = *dispatcher_.getManifoldByIndexInternal(m);
    const ColliderTag& a = *tagOf(manifold.getBody0());
    const ColliderTag& b = *tagOf(manifold.getBody1());
    if (!(isGhost(a.body) || isGhost(b.body))) continue;
    for (int k = 0; k < manifold.getNumContacts(); ++k) {
      if (manifold.getContactPoint(k).getDistance() >= 0.0) continue;
      noteOverlap(a, b);
      noteOverlap(b, a);
      break;
    }
  }
}

void GameBodies::settle(double step_s) noexcept {
  step_s_ = step_s;
  if (ghosts_ == 0) return;
  findOverlaps();
  for (int slot = 0; slot < count(); ++slot) {
    if (slots_[slot].state != SlotState::kGhost) continue;
    if (!overlaps_[slot]) {
      becomeSolid(slot);
    } else if (slots_[slot].refuse_overlap) {
      refuse(slot, OrderRefusal::kOverlap);
      park(slot);
    } else {
      slots_[slot].overlapped = true;
    }
  }
}

}  // namespace wholehand::bullet
