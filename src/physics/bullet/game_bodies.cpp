#include "physics/bullet/game_bodies.hpp"

#include "core/body_order.hpp"
#include "physics/bullet/bullet_types.hpp"

#include <Eigen/Geometry>

namespace wholehand::bullet {
namespace {

const Vec3 kParkedAt{0.0, 0.0, -10.0};

// A target further than this from the one before is a teleport: a body that is drawn there did not
// move there (15 m/s at 60 frames a second), and must not sweep through the hand.
constexpr double kFarTarget_m = 0.25;

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

void GameBodies::refuse(int slot, OrderRefusal refusal) noexcept {
  if (refusal == OrderRefusal::kNone || refused_count_ == kMaxCommands) return;
  refused_[refused_count_++] = {slot, refusal};
}

void GameBodies::obey(const Command& command) noexcept {
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
  if (order.slot < 0 || order.slot >= count()) return refuse(order.slot, OrderRefusal::kNoSuchSlot);
  Slot& slot = slots_[order.slot];
  const auto say = [&](OrderRefusal refusal) noexcept { refuse(order.slot, refusal); };
  if (slot.state != SlotState::kParked) return say(OrderRefusal::kSlotTaken);
  if (order.generation < 1) return say(OrderRefusal::kWrongGeneration);
  if (!alive_) return say(OrderRefusal::kSilent);
  const ShapeSets::Set* set = sets_.find(order.shape_set);
  if (set == nullptr) return say(OrderRefusal::kNoSuchShapes);
  if (!isBodyPose(order.pose) || !isBodyOwner(order.owner) ||
      !(order.velocity_m_s.eigen().norm() <= kMostSpawnSpeed_m_s)) {
    return say(OrderRefusal::kBadPose);
  }
  if (!(order.mass_kg >= budget_.least_kg && order.mass_kg <= budget_.most_kg) ||
      !(order.friction >= 0.0 && order.friction <= kMostBodyFriction)) {
    return say(OrderRefusal::kBadMass);
  }
  if (order.owner != BodyOwner::kFixed && movingCount() >= budget_.awake) {
    return say(OrderRefusal::kBudget);
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
  if (index < 0 || index >= count()) return refuse(index, OrderRefusal::kNoSuchSlot);
  Slot& slot = slots_[index];
  if (slot.state == SlotState::kParked || command.value != slot.generation) {
    return refuse(index, OrderRefusal::kWrongGeneration);
  }
  if (command.type == CommandType::kRemove) return letGo(index, Then::kPark);
  if (slot.state == SlotState::kLettingGo) {
    const bool follows = command.type == CommandType::kBodyTarget && slot.by_target &&
                         slot.then == Then::kTeleport && isBodyPose(poseOf(command));
    if (!follows) return refuse(index, OrderRefusal::kBusy);
    slot.there = poseOf(command);
    return;
  }
  if (command.type == CommandType::kSetOwner) {
    const BodyOwner owner = spawnOrderOf(command).owner;
    if (!isBodyOwner(owner)) return refuse(index, OrderRefusal::kBadPose);
    if (owner == slot.owner) return;
    if (slot.owner == BodyOwner::kFixed && movingCount() >= budget_.awake) {
      return refuse(index, OrderRefusal::kBudget);
    }
    slot.next_owner = owner;
    return letGo(index, Then::kSetOwner);
  }
  const BodyPose pose = poseOf(command);
  if (!isBodyPose(pose)) return refuse(index, OrderRefusal::kBadPose);
  if (command.type == CommandType::kTeleport) {
    slot.there = pose;
    slot.by_target = false;
    return letGo(index, Then::kTeleport);
  }
  if (slot.owner != BodyOwner::kGame) return refuse(index, OrderRefusal::kNotTheGames);
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
  pairs_.placed(body);  // wakes what lies on it
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

}  // namespace wholehand::bullet
