// Driven bodies are pulled to the game's targets.
#include "physics/bullet/bullet_types.hpp"
#include "physics/bullet/free_motion.hpp"
#include "physics/bullet/game_bodies.hpp"

#include <Eigen/Geometry>

#include <algorithm>
#include <cmath>

namespace wholehand::bullet {
namespace {

// A driven body follows v = (ω/2) (target − x), at most kMostDrive_m_s, through a damper of 2 m ω:
// near the target that is a critically damped spring of m ω².
constexpr double kDriveRate_per_s = 20.0;
constexpr double kMostDrive_m_s = 0.5;
constexpr double kMostMomentum_ns = 0.05;  // a heavy body moves more slowly
constexpr double kMostForce_n = 5.0;       // of pull and turn; of all bodies while the hand touches
constexpr double kTurnShare = 0.1;         // of kMostForce_n, at the body's outermost point

/// Rotation vector from one orientation to another, the short way.
btVector3 turnBetween(const Eigen::Quaterniond& from, const Eigen::Quaterniond& to) noexcept {
  Eigen::Quaterniond turn = to * from.conjugate();
  if (turn.w() < 0.0) turn.coeffs() = -turn.coeffs();
  const double sine = turn.vec().norm();
  const double angle = 2.0 * std::atan2(sine, turn.w());
  return toBt(Eigen::Vector3d(turn.vec() * (sine > 1e-12 ? angle / sine : 2.0)));
}

}  // namespace

// Bodies that push one another push the hand together.
void GameBodies::drive(double step_s) noexcept {
  if (used_ == 0) return;
  double together_n = 0.0;
  for (int slot = 0; slot < count(); ++slot) {
    if (!isDriven(slot)) continue;
    pulls_[slot] = pullOf(slot, step_s);
    together_n += pulls_[slot].size_n;
  }
  const double most_n = kMostForce_n * force_share_;
  const bool shared = hand_touches_ && together_n > most_n;
  const double share = shared ? most_n / together_n : 1.0;
  for (int slot = 0; slot < count(); ++slot) {
    if (!isDriven(slot) || slots_[slot].state == SlotState::kGhost) continue;
    pulls_[slot].share = share;
    bodyOf(slot).rigid().applyCentralForce(share * pulls_[slot].force_n);
    bodyOf(slot).rigid().applyTorque(share * pulls_[slot].torque_nm);
  }
  const auto [power_w, energy_j] = powerAndEnergy();
  power_w_ = power_w;
  received_j_ += std::max(0.0, energy_j - held_j_);  // what was spawned or thrown since
}

std::pair<double, double> GameBodies::powerAndEnergy() noexcept {
  double power_w = 0.0, energy_j = 0.0;
  for (int slot = 0; slot < count(); ++slot) {
    const SlotState state = slots_[slot].state;
    if (state == SlotState::kParked || state == SlotState::kGhost ||
        !resting_.awake(first_ + slot)) {
      continue;
    }
    const btRigidBody& rigid = bodyOf(slot).rigid();
    const btVector3& velocity = rigid.getLinearVelocity();
    const btVector3& spin = rigid.getAngularVelocity();
    energy_j += kineticEnergy(rigid);
    power_w += slots_[slot].mass_kg * rigid.getGravity().dot(velocity);
    if (!isDriven(slot)) continue;
    power_w += pulls_[slot].share *
               (pulls_[slot].force_n.dot(velocity) + pulls_[slot].torque_nm.dot(spin));
  }
  return {power_w, energy_j};
}

bool GameBodies::isDriven(int slot) const noexcept {
  const Slot& s = slots_[slot];
  return s.state != SlotState::kParked && s.owner == BodyOwner::kGame &&
         resting_.awake(first_ + slot);
}

GameBodies::Pull GameBodies::pullOf(int index, double step_s) noexcept {
  const Slot& slot = slots_[index];
  btRigidBody& rigid = bodyOf(index).rigid();
  const BodyPose now = poseNow(index);
  const double rate = kDriveRate_per_s;
  const btVector3 to_target =
      toBt(slot.target.position_m.eigen()) - rigid.getWorldTransform().getOrigin();
  const btVector3 turn =
      turnBetween(now.orientation_xyzw.eigen(), slot.target.orientation_xyzw.eigen().normalized());
  const double most_m_s = std::min(kMostDrive_m_s, kMostMomentum_ns / slot.mass_kg);
  const btVector3 velocity = atMost(0.5 * rate * to_target, most_m_s);
  const btVector3 spin = atMost(0.5 * rate * turn, most_m_s / slot.radius_m);
  if (slot.state == SlotState::kGhost) {  // nothing holds it back
    btTransform moved;
    rigid.setLinearVelocity(velocity);
    rigid.setAngularVelocity(spin);
    rigid.predictIntegratedTransform(step_s, moved);
    rigid.proceedToTransform(moved);
    return {};
  }
  const double most_n = kMostForce_n * force_share_;
  const double damper = 2.0 * rate;
  Pull pull;
  pull.force_n = atMost(slot.mass_kg * damper * (velocity - rigid.getLinearVelocity()),
                        (1.0 - kTurnShare) * most_n);
  const btMatrix3x3 inertia = rigid.getInvInertiaTensorWorld().inverse();
  pull.torque_nm = atMost(inertia * (damper * (spin - rigid.getAngularVelocity())),
                          kTurnShare * most_n * slot.radius_m);
  pull.size_n = pull.force_n.length() + pull.torque_nm.length() / slot.radius_m;
  return pull;
}

}  // namespace wholehand::bullet
