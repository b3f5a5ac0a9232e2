#include "loop/physics/bullet/game_bodies.hpp"

#include "loop/core/body_order.hpp"
#include "loop/physics/bullet/bullet_types.hpp"
#include "loop/physics/bullet/free_motion.hpp"

#include <Eigen/Geometry>

#include <algorithm>
#include <cmath>

namespace wholehand::bullet {
namespace {

const Vec3 kParkedAt{0.0, 0.0, -10.0};

// A target farther than this from the one before is a teleport: the displayed body did not move
// that far in one frame (15 m/s at 60 frames a second), and must not sweep through the hand.
constexpr double kFarTarget_m = 0.25;

// Bound of the sum of the normal forces between the hand and one body. Without it, a hand that
// wedges between two fixed bodies was seen to be pressed with 33 kN from both sides. After an
// overlap the bound begins with kFirst_n and grows by the factor e in kGrow_s.
constexpr double kMostContact_n = 100.0;
constexpr double kFirst_n = 0.5, kGrow_s = 0.03;

// A driven body follows the velocity v = (ω/2) (target − x), at most kMostDrive_m_s, through a
// damper of 2 m ω. Near the target this is a critically damped spring of stiffness m ω².
constexpr double kDriveRate_per_s = 20.0;
constexpr double kMostDrive_m_s = 0.5;     // largest speed of a driven body
constexpr double kMostMomentum_ns = 0.05;  // largest momentum: a heavy body is moved more slowly
constexpr double kMostForce_n = 5.0;  // largest force of pull and torque; of all bodies together
                                      // while the hand touches something
// share of kMostForce_n for the torque, at the body's outermost point
constexpr double kTurnShare = 0.1;

/// Shortest rotation vector from one orientation to another.
btVector3 turnBetween(const Eigen::Quaterniond& from, const Eigen::Quaterniond& to) noexcept {
  Eigen::Quaterniond turn = to * from.conjugate();
  if (turn.w() < 0.0) turn.coeffs() = -turn.coeffs();
  const double sine = turn.vec().norm();
  const double angle = 2.0 * std::atan2(sine, turn.w());
  return toBt(Eigen::Vector3d(turn.vec() * (sine > 1e-12 ? angle / sine : 2.0)));
}

// Rate at which the force of the hand on a body fades before the body is taken away. The arm
// follows the fading force: at 300 N/m it moves at 0.05 m/s.
constexpr double kLetGoRate_n_s = 15.0, kLeastLetGo_s = 0.1;

// A target is followed for kTargetLives_s. While the game is silent, the force of driven bodies
// fades within kSilentFade_s, and its bodies are removed after kLeaves_s.
constexpr double kTargetLives_s = 0.1, kSilentFade_s = 0.2, kLeaves_s = 5.0;

// Largest speeds of a body. A faster body is slowed down and removed.
constexpr double kMostSpeed_m_s = 4.9, kMostSpin_rad_s = 200.0;
static_assert(kMostSpin_rad_s < kMostSpawnSpin_rad_s, "a body may return to its slot");

}  // namespace

GameBodies::GameBodies(const SceneModel& scene, std::vector<BulletBody>& bodies,
                       RestingBodies& resting, ColliderPairs& pairs, ReducedContactSolver& solver,
                       btCollisionDispatcher& dispatcher)
    : budget_(scene.game),
      gravity_(toBt(scene.gravity_m_s2)),
      bodies_(bodies),
      resting_(resting),
      pairs_(pairs),
      solver_(solver),
      dispatcher_(dispatcher),
      first_(static_cast<int>(bodies.size()) - scene.game.slots),
      sets_(scene.game),
      slots_(scene.game.slots) {
  for (int slot = 0; slot < count(); ++slot) bodyOf(slot).putAt({kParkedAt, {}}, {});
}

void GameBodies::refuse(int slot, BodyRefusal refusal) noexcept {
  if (refusal == BodyRefusal::kNone || refused_count_ == kMaxCommands) return;
  refused_[refused_count_++] = {slot, refusal};
}

void GameBodies::apply(const Command& command) noexcept {
  switch (command.type) {
    case CommandType::kShapeSet:
    case CommandType::kShapePiece:
    case CommandType::kShapeVertices:
      return refuse(-1, sets_.take(command));
    case CommandType::kSpawn:
      return spawn(spawnOrderOf(command));
    case CommandType::kRemove:
    case CommandType::kTeleport:
    case CommandType::kSetOwner:
    case CommandType::kBodyTarget:
      return orderBody(command);
    default:
      return;
  }
}

int GameBodies::movingCount() const noexcept {
  int count = 0;
  for (std::size_t i = 0; i < slots_.size(); ++i) {
    if (slots_[i].state != SlotState::kParked && slots_[i].owner != BodyOwner::kFixed &&
        resting_.awake(first_ + static_cast<int>(i))) {
      ++count;
    }
  }
  return count;
}

void GameBodies::spawn(const SpawnOrder& order) noexcept {
  if (order.slot < 0 || order.slot >= count()) return refuse(order.slot, BodyRefusal::kNoSuchSlot);
  Slot& slot = slots_[order.slot];
  const auto refuse_slot = [&](BodyRefusal refusal) noexcept { refuse(order.slot, refusal); };
  // Refuses invalid orders and those that exceed the budget.
  if (slot.state != SlotState::kParked) return refuse_slot(BodyRefusal::kSlotTaken);
  if (order.generation < 1) return refuse_slot(BodyRefusal::kWrongGeneration);
  if (!alive_) return refuse_slot(BodyRefusal::kSilent);
  const ShapeSets::Set* set = sets_.find(order.shape_set);
  if (set == nullptr) return refuse_slot(BodyRefusal::kNoSuchShapes);
  if (!isBodyPose(order.pose) || !isBodyOwner(order.owner) ||
      !(order.velocity_m_s.eigen().norm() <= kMostSpawnSpeed_m_s) ||
      !(order.spin_rad_s.eigen().norm() <= kMostSpawnSpin_rad_s)) {
    return refuse_slot(BodyRefusal::kBadPose);
  }
  if (!(order.mass_kg >= budget_.least_kg && order.mass_kg <= budget_.most_kg) ||
      !(order.friction >= 0.0 && order.friction <= kMostBodyFriction)) {
    return refuse_slot(BodyRefusal::kBadMass);
  }
  if (order.owner != BodyOwner::kFixed && movingCount() >= budget_.awake) {
    return refuse_slot(BodyRefusal::kBudget);
  }
  slot = Slot{};
  slot.generation = order.generation;
  slot.owner = order.owner;
  slot.shape_set = order.shape_set;
  slot.mass_kg = order.mass_kg;
  slot.friction = order.friction;
  slot.radius_m = set->radius_m;
  slot.velocity_m_s = order.velocity_m_s;
  slot.spin_rad_s = order.spin_rad_s;
  slot.refuse_overlap = order.refuse_overlap;
  slot.target = order.pose;
  sets_.acquire(order.shape_set);
  ++used_;
  bodyOf(order.slot).setPieces(sets_.piecesOf(order.shape_set), set->pieces, set->from_body);
  slot.there = order.pose;
  becomeGhost(order.slot);
}

void GameBodies::orderBody(const Command& command) noexcept {
  const int index = command.index;
  if (index < 0 || index >= count()) return refuse(index, BodyRefusal::kNoSuchSlot);
  Slot& slot = slots_[index];
  if (slot.state == SlotState::kParked || command.value != slot.generation) {
    return refuse(index, BodyRefusal::kWrongGeneration);
  }
  if (command.type == CommandType::kRemove) return letGo(index, Then::kPark);
  // While the body is being released, only a further far target is accepted.
  if (slot.state == SlotState::kLettingGo) {
    const bool follows = command.type == CommandType::kBodyTarget && slot.by_target &&
                         slot.then == Then::kTeleport && isBodyPose(poseOf(command));
    if (!follows) return refuse(index, BodyRefusal::kLettingGo);
    slot.there = poseOf(command);
    return;
  }
  if (command.type == CommandType::kSetOwner) {
    const BodyOwner owner = spawnOrderOf(command).owner;
    if (!isBodyOwner(owner)) return refuse(index, BodyRefusal::kBadPose);
    if (owner == slot.owner) return;
    if (slot.owner == BodyOwner::kFixed && movingCount() >= budget_.awake) {
      return refuse(index, BodyRefusal::kBudget);
    }
    slot.next_owner = owner;
    return letGo(index, Then::kSetOwner);
  }
  const BodyPose pose = poseOf(command);
  if (!isBodyPose(pose)) return refuse(index, BodyRefusal::kBadPose);
  if (command.type == CommandType::kTeleport) {
    slot.there = pose;
    slot.by_target = false;
    return letGo(index, Then::kTeleport);
  }
  // Target of a driven body; a target too far for one frame is a teleport.
  if (slot.owner != BodyOwner::kGame) return refuse(index, BodyRefusal::kNotTheGames);
  if ((pose.position_m.eigen() - slot.target.position_m.eigen()).norm() > kFarTarget_m) {
    slot.there = pose;
    slot.by_target = true;
    return letGo(index, Then::kTeleport);
  }
  slot.target = pose;
  slot.target_age_s = 0.0;
  resting_.disturb(first_ + index);
}

void GameBodies::park(int index) noexcept {
  Slot& slot = slots_[index];
  const int body = first_ + index;
  if (slot.state == SlotState::kGhost) --ghosts_;
  pairs_.placed(body);  // wakes the bodies that lie on it
  resting_.setMoves(body, false);
  solver_.unboundBody(body);
  sets_.release(slot.shape_set);
  BulletBody& parked = bodyOf(index);
  parked.setPieces(nullptr, 0, Eigen::Quaterniond::Identity());
  parked.setMass(0.0, btVector3(0, 0, 0), 0.0, btVector3(0, 0, 0));
  parked.putAt({kParkedAt, {}}, {});
  pairs_.forget(body);
  slot = Slot{};
  --used_;
  ++version_;
}

BodyPose GameBodies::poseNow(int slot) const noexcept {
  const BodyState state = bodies_[first_ + slot].state();
  return {state.position_m, state.orientation_xyzw};
}

void GameBodies::report(PoolReport& report) noexcept {
  report.count = count();
  report.first_body = first_;
  report.refused_count = refused_count_;
  report.refused = refused_;
  report.quarantined = quarantined_;
  report.moving = used_ > 0 ? movingCount() : 0;
  for (int i = 0; i < count(); ++i) {
    report.slots[i] = {slots_[i].generation, slots_[i].state, slots_[i].owner,
                       slots_[i].solid_count};
  }
  report.held_j = held_j_;
  report.received_j = received_j_;
  received_j_ = 0.0;
  refused_count_ = 0;
  quarantined_ = -1;
}

// Ghosts: bodies with a pose that become solid when they overlap nothing.

// Places the ghost at slot.there. All bodies that rested on it, or where it appears, wake.
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
  pairs_.forget(body);  // its contact points were never solved
  if (slot.owner == BodyOwner::kFixed) resting_.setMoves(body, false);
}

void GameBodies::firm(int index, double step_s) noexcept {
  Slot& slot = slots_[index];
  slot.solid_s += step_s;
  const double grown_n = kFirst_n * std::exp(slot.solid_s / kGrow_s);
  solver_.boundBody(first_ + index, std::min(grown_n, kMostContact_n) * step_s);
}

// Of two ghosts that overlap, the one in the lower slot becomes solid first, so that they do not
// wait for each other.
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
      refuse(slot, BodyRefusal::kOverlap);
      park(slot);
    } else {
      slots_[slot].overlapped = true;
    }
  }
}

// Driven bodies: the loop pulls them to the game's targets.

// All pulls share one bound while the hand touches something, because bodies that push each other
// push the hand together.
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
  // Energy of bodies that were spawned or thrown since.
  received_j_ += std::max(0.0, energy_j - held_j_);
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
  if (slot.state == SlotState::kGhost) {  // a ghost meets no resistance
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

// Releases: orders, silence of the game or too much speed take a body away from the hand.

// Takes the body away at once when the hand does not press it; otherwise lets the force fade first.
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

// Limits speed and distance of a body. A state that is not finite is left unchanged: observe() then
// reports it and the run stops.
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
