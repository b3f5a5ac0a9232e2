#include "rig/registry/body_registry.hpp"

#include "loop/core/body_order.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <optional>

namespace wholehand {
namespace {

double distanceToSegment(const Eigen::Vector3d& p, const Eigen::Vector3d& a,
                         const Eigen::Vector3d& b) {
  const Eigen::Vector3d along = b - a;
  const double length2 = along.squaredNorm();
  const double share = length2 > 0.0 ? std::clamp((p - a).dot(along) / length2, 0.0, 1.0) : 0.0;
  return (p - a - share * along).norm();
}

}  // namespace

HandReach::HandReach(const HandModel& hand, const DeviceModel& device, double within_s)
    : hand_(hand), device_(device), within_s_(within_s), body_(hand) {
  capsules_.resize(hand.capsules.size());
}

double HandReach::travelOf(int link, const Eigen::Vector3d& point_m,
                           const AxisPosition& change) const {
  std::array<std::array<double, kMaxAxes>, 3> rows{};
  for (int k = 0; k < 3; ++k) {
    body_.reducedPointRow(link, point_m, Eigen::Vector3d::Unit(k), rows[k].data());
  }
  double slid_m2 = 0.0, turned_m = 0.0;
  for (int a = 0; a < change.size(); ++a) {
    const double moved_m = change[a] * std::hypot(rows[0][a], rows[1][a], rows[2][a]);
    if (device_.axes[a].kind == AxisKind::kTranslation) {
      slid_m2 += moved_m * moved_m;
    } else {
      turned_m += moved_m;
    }
  }
  return std::sqrt(slid_m2) + turned_m;
}

void HandReach::look(const AxisPosition& q_s, const JointPosition& theta) {
  body_.updateKinematics(theta);
  AxisPosition change(q_s.size());
  for (int a = 0; a < q_s.size(); ++a) {
    const DeviceAxis& axis = device_.axes[a];
    const double room = std::max({axis.upper - q_s[a], q_s[a] - axis.lower, 0.0});
    change[a] = std::min(axis.speed_limit * within_s_, room);
  }
  middle_m_.setZero();
  for (std::size_t i = 0; i < capsules_.size(); ++i) {
    const Capsule& capsule = hand_.capsules[i];
    const Pose& at = body_.linkPose(capsule.link);
    Finger& out = capsules_[i];
    out.a_m = at * capsule.a_m;
    out.b_m = at * capsule.b_m;
    out.radius_m = capsule.radius_m;
    out.travel_m =
        std::max(travelOf(capsule.link, out.a_m, change), travelOf(capsule.link, out.b_m, change));
    middle_m_ += 0.5 * (out.a_m + out.b_m) / static_cast<double>(capsules_.size());
  }
  farthest_m_ = extent_m_ = 0.0;
  for (const Finger& c : capsules_) {
    const double far_m =
        std::max((c.a_m - middle_m_).norm(), (c.b_m - middle_m_).norm()) + c.radius_m;
    extent_m_ = std::max(extent_m_, far_m);
    farthest_m_ = std::max(farthest_m_, far_m + c.travel_m);
  }
}

HandReach::Distance HandReach::to(const Eigen::Vector3d& centre_m, double radius_m,
                                  double far_m) const {
  const double away_m = (centre_m - middle_m_).norm() - radius_m;
  if (away_m - farthest_m_ > far_m) return {away_m - extent_m_, away_m - farthest_m_};
  Distance out{std::numeric_limits<double>::infinity(), std::numeric_limits<double>::infinity()};
  for (const Finger& c : capsules_) {
    const double now_m = distanceToSegment(centre_m, c.a_m, c.b_m) - c.radius_m - radius_m;
    out.now_m = std::min(out.now_m, now_m);
    out.missed_m = std::min(out.missed_m, now_m - c.travel_m);
  }
  return out;
}

namespace {

/// An empty slot is below this height; bodies stay within 5 m.
constexpr double kParked_z_m = -8.0;
constexpr double kRefusedFor_s = 0.25;  ///< wait before a body that the loop refused is tried again
constexpr double kChoose_s = 0.02;
/// Silence of the holder after which the loop releases all bodies.
constexpr double kLeaves_s = 5.0;

bool fixed(BodyOwner owner) {
  return owner == BodyOwner::kFixed;
}

/// True for refusals that only a spawn can get.
bool refusesSpawn(BodyRefusal refusal) {
  return refusal == BodyRefusal::kSlotTaken || refusal == BodyRefusal::kNoSuchShapes ||
         refusal == BodyRefusal::kBadMass || refusal == BodyRefusal::kBudget ||
         refusal == BodyRefusal::kSilent;
}

// Constants for the choice of the bodies that get slots.
constexpr double kDriven_m_s = 0.5;  ///< largest speed of a body that the game moves
// Hysteresis of a slot. A body keeps its slot until it is kLateOut_m out of reach or another body
// is kNearer_m nearer, and at least kStays_s long and for kTouchStays_s after a touch.
constexpr double kLateOut_m = 0.1, kNearer_m = 0.05, kStays_s = 0.3, kTouchStays_s = 0.2;

}  // namespace

void BodyRegistry::begin(const HandModel& hand, const DeviceModel& device, const GameBudget& budget,
                         int first_body, int refused_event) {
  end();
  budget_ = budget;
  first_body_ = first_body;
  refused_event_ = refused_event;
  last_generation_ = kFirstGeneration;
  reach_ = std::make_unique<HandReach>(hand, device, kReachWithin_s);
}

void BodyRegistry::end() {
  for (auto& [number, body] : bodies_) {
    body.slot = -1;
    body.moved_away = false;
    body.not_before_s = 0.0;
    setWhereabouts(body, Whereabouts::kOutOfReach);
  }
  held_ = {};
  fixed_ = {};
  others_until_s_ = {};
  for_loop_.clear();
  reach_.reset();
  time_s_ = chosen_s_ = 0.0;
  silent_since_s_ = -1.0;
}

void BodyRegistry::clear() {
  if (!bodies_.empty()) ++version_;
  bodies_.clear();
  for (HeldBody& held : held_) {
    if (held.number != 0) held.number = -1;
  }
}

BodyRegistry::Body* BodyRegistry::find(int number) {
  const auto found = bodies_.find(number);
  return found == bodies_.end() ? nullptr : &found->second;
}

void BodyRegistry::setWhereabouts(Body& body, Whereabouts whereabouts) {
  if (body.whereabouts == whereabouts) return;
  body.whereabouts = whereabouts;
  ++version_;
}

bool BodyRegistry::usesShapes(int shape_set) const {
  return std::any_of(bodies_.begin(), bodies_.end(),
                     [&](const auto& at) { return at.second.spawn.shape_set == shape_set; });
}

std::vector<RegisteredBody> BodyRegistry::bodies() const {
  std::vector<RegisteredBody> out;
  out.reserve(bodies_.size());
  for (const auto& [number, body] : bodies_) {
    const int slot = body.whereabouts == Whereabouts::kInSlot ? body.slot : -1;
    out.push_back({number, body.spawn.generation, body.spawn.shape_set, slot, body.whereabouts,
                   body.spawn.pose});
  }
  return out;
}

BodyRefusal BodyRegistry::add(const SpawnOrder& order, double radius_m) {
  if (!isRegistered(order.slot)) return BodyRefusal::kNoSuchSlot;
  if (find(order.slot) != nullptr) return BodyRefusal::kSlotTaken;
  if (bodies_.size() >= std::size_t{kMostRegistered}) return BodyRefusal::kBudget;
  if (silent_since_s_ >= 0.0) return BodyRefusal::kSilent;
  Body body;
  body.spawn = order;
  body.spawn.refuse_overlap = false;
  body.radius_m = radius_m;
  bodies_.emplace(order.slot, body);
  ++version_;
  return BodyRefusal::kNone;
}

BodyRefusal BodyRegistry::apply(const Command& command) {
  Body* body = find(command.index);
  if (body == nullptr || command.value != body->spawn.generation) {
    return BodyRefusal::kWrongGeneration;
  }
  if (command.type == CommandType::kBodyTarget && body->spawn.owner != BodyOwner::kGame) {
    return BodyRefusal::kNotTheGames;
  }
  if (body->slot >= 0) {
    if (const BodyRefusal no = orderInSlot(*body, command); no != BodyRefusal::kNone) return no;
  }
  switch (command.type) {
    case CommandType::kRemove:
      bodies_.erase(command.index);
      ++version_;
      break;
    case CommandType::kSetOwner:
      body->spawn.owner = spawnOrderOf(command).owner;
      break;
    default:  // outside the slots nothing can obstruct a pose, so it is accepted
      body->spawn.pose = poseOf(command);
      body->spawn.velocity_m_s = body->spawn.spin_rad_s = Vec3{};
      if (body->slot < 0 || body->moved_away) ++moves_;
  }
  return BodyRefusal::kNone;
}

BodyRefusal BodyRegistry::orderInSlot(Body& body, const Command& command) {
  HeldBody& held = held_[body.slot];
  if (held.leaving) {  // the body is leaving its slot: the command applies after it has left
    if (command.type == CommandType::kRemove) held.number = -1;
    const bool moves =
        command.type == CommandType::kTeleport || command.type == CommandType::kBodyTarget;
    body.moved_away = body.moved_away || moves;
    return BodyRefusal::kNone;
  }
  Command order = command;
  order.index = body.slot;
  order.value = held.generation;
  if (command.type == CommandType::kSetOwner) {
    const bool moves = !fixed(spawnOrderOf(command).owner);
    const auto moving = std::count_if(held_.begin(), held_.end(),
                                      [](const HeldBody& h) { return h.number != 0 && h.moves; });
    if (moves && !held.moves && moving >= budget_.awake) return BodyRefusal::kBudget;
    held.moves = held.moves || moves;
  }
  if (command.type == CommandType::kRemove) {
    held.number = -1;
    held.leaving = true;
    held.since_s = time_s_;
  }
  for_loop_.push_back(order);
  return BodyRefusal::kNone;
}

bool BodyRegistry::parked(int slot, const TickRecord& record) const {
  const int index = first_body_ + slot;
  return index >= record.body_count || record.bodies[index].position_m.z < kParked_z_m;
}

void BodyRegistry::onRecord(const TickRecord& record) {
  if (reach_ == nullptr) return;
  time_s_ = record.time_s;
  const bool silent = any(record.faults & (Fault::kHolderSilent | Fault::kStopRequested));
  if (!silent) silent_since_s_ = -1.0;
  if (silent && silent_since_s_ < 0.0) silent_since_s_ = time_s_;
  if (silent && time_s_ - silent_since_s_ > kLeaves_s) clear();
  watchOthers(record);
  noteRefused(record);
  for (int slot = 0; slot < budget_.slots; ++slot) {
    if (held_[slot].number != 0) followSlot(slot, record);
  }
  if (silent || !for_loop_.empty() || time_s_ - chosen_s_ < kChoose_s) return;
  chosen_s_ = time_s_;
  if (!bodies_.empty()) choose(record);
}

// Notes which bodies of other programs are fixed, and which registered bodies the hand touches.
void BodyRegistry::watchOthers(const TickRecord& record) {
  for (int i = 0; i < record.command_count; ++i) {
    const Command& command = record.commands[i];
    const bool relevant =
        command.type == CommandType::kSpawn || command.type == CommandType::kSetOwner;
    if (!relevant || command.index < 0 || command.index >= budget_.slots) continue;
    fixed_[command.index] = fixed(spawnOrderOf(command).owner);
  }
  for (int i = 0; i < record.contact_count; ++i) {
    const int slot = record.contacts[i].body - first_body_;
    if (slot >= 0 && slot < budget_.slots) held_[slot].touched_s = time_s_;
  }
}

void BodyRegistry::noteRefused(const TickRecord& record) {
  for (int i = 0; i < record.exercise.event_count; ++i) {
    const ExerciseEvent& event = record.exercise.events[i];
    if (event.type != refused_event_ || event.index < 0 || event.index >= budget_.slots) continue;
    const HeldBody& held = held_[event.index];
    const auto refusal = static_cast<BodyRefusal>(static_cast<int>(event.value));
    if (held.number != 0 && !held.seen && refusesSpawn(refusal)) freeSlot(event.index);
  }
}

void BodyRegistry::freeSlot(int slot) {
  if (Body* body = find(held_[slot].number)) {
    body->slot = -1;
    body->moved_away = false;
    if (!held_[slot].seen) body->not_before_s = time_s_ + kRefusedFor_s;
    setWhereabouts(*body, Whereabouts::kOutOfReach);
  }
  held_[slot] = HeldBody{};
}

void BodyRegistry::followSlot(int slot, const TickRecord& record) {
  HeldBody& held = held_[slot];
  if (!parked(slot, record)) {
    if (!held.seen) held.since_s = time_s_;
    held.seen = true;
    return keepState(slot, record.bodies[first_body_ + slot]);
  }
  if (!held.seen) {
    if (time_s_ - held.since_s < kAnswered_s) return;
    // The loop may still execute the spawn later, so the slot is cleared.
    for_loop_.push_back(removeCommand(slot, held.generation));
  } else if (!held.leaving && find(held.number) != nullptr) {
    // The loop removed the body because it was too fast or outside the world.
    bodies_.erase(held.number);
    ++version_;
  }
  freeSlot(slot);
}

void BodyRegistry::keepState(int slot, const BodyState& state) {
  Body* body = find(held_[slot].number);
  if (body == nullptr || body->moved_away) return;
  const Eigen::Vector3d moved = state.position_m.eigen() - body->spawn.pose.position_m.eigen();
  const bool stands = moved.isZero(0.0) && state.velocity_m_s.eigen().isZero(0.0);
  body->spawn.pose = {state.position_m, state.orientation_xyzw};
  if (stands && body->spawn.owner == BodyOwner::kLoop) return;  // a ghost has no velocity yet
  body->spawn.velocity_m_s = state.velocity_m_s;
  body->spawn.spin_rad_s = state.angular_velocity_rad_s;
}

bool BodyRegistry::mustStay(const HeldBody& held) const {
  return !held.seen || time_s_ - held.since_s < kStays_s ||
         (held.touched_s >= 0.0 && time_s_ - held.touched_s < kTouchStays_s);
}

/// Rank for a slot: distance from the hand, minus kNearer_m for a body in a slot; none: out of
/// reach.
std::optional<double> BodyRegistry::rankOf(const Body& body) const {
  const bool in_slot = body.slot >= 0;
  double speed_m_s = 0.0;
  if (body.spawn.owner == BodyOwner::kLoop) speed_m_s = body.spawn.velocity_m_s.eigen().norm();
  if (body.spawn.owner == BodyOwner::kGame) speed_m_s = kDriven_m_s;
  const double margin_m = kReachWithin_s * speed_m_s + (in_slot ? kLateOut_m : 0.0);
  const HandReach::Distance at =
      reach_->to(body.spawn.pose.position_m.eigen(), body.radius_m, margin_m);
  if (at.missed_m > margin_m) return std::nullopt;
  return at.now_m - (in_slot ? kNearer_m : 0.0);
}

std::vector<BodyRegistry::Candidate> BodyRegistry::candidates() {
  std::vector<Candidate> out;
  for (auto& [number, body] : bodies_) {
    if (body.slot >= 0 && held_[body.slot].leaving) continue;
    if (body.slot >= 0 && mustStay(held_[body.slot])) {
      out.push_back({-std::numeric_limits<double>::infinity(), number});
      continue;
    }
    const std::optional<double> rank_m = rankOf(body);
    if (body.slot < 0) {
      setWhereabouts(body, rank_m ? Whereabouts::kLeftOut : Whereabouts::kOutOfReach);
      if (time_s_ < body.not_before_s) continue;
    }
    if (rank_m) out.push_back({*rank_m, number});
  }
  std::sort(out.begin(), out.end(), [](const Candidate& a, const Candidate& b) {
    return a.rank_m != b.rank_m ? a.rank_m < b.rank_m : a.number < b.number;
  });
  return out;
}

// Number of movable bodies in slots. Bodies at rest count, because the hand may wake all of them at
// once.
int BodyRegistry::movingNow(const TickRecord& record) const {
  int moving = 0;
  for (int slot = 0; slot < budget_.slots; ++slot) {
    if (held_[slot].number != 0) {
      moving += held_[slot].moves ? 1 : 0;
    } else if (!parked(slot, record) && !fixed_[slot]) {
      ++moving;
    }
  }
  return moving;
}

// Returns the free slot with the lowest index, because a state message contains the poses up to the
// last slot in use; -1: none.
int BodyRegistry::freeOne(const TickRecord& record) const {
  for (int slot = 0; slot < budget_.slots; ++slot) {
    const bool others = time_s_ < others_until_s_[slot];
    if (held_[slot].number == 0 && !others && parked(slot, record)) return slot;
  }
  return -1;
}

void BodyRegistry::choose(const TickRecord& record) {
  reach_->look(record.q_s, record.theta);
  int slots = budget_.slots, moving = budget_.awake;
  for (int slot = 0; slot < budget_.slots; ++slot) {  // subtracts slots of other programs
    if (held_[slot].number != 0 || parked(slot, record)) continue;
    --slots;
    if (!fixed_[slot]) --moving;
  }
  std::vector<int> wanted;
  for (const Candidate& candidate : candidates()) {
    const bool moves = bodies_.at(candidate.number).spawn.owner != BodyOwner::kFixed;
    if (slots <= 0 || (moves && moving <= 0)) continue;
    --slots;
    if (moves) --moving;
    wanted.push_back(candidate.number);
  }
  giveSlots(wanted, record);
}

void BodyRegistry::giveSlots(const std::vector<int>& wanted, const TickRecord& record) {
  std::array<bool, kMaxSlots> stays{};
  for (const int number : wanted) {
    const int slot = bodies_.at(number).slot;
    if (slot >= 0) stays[slot] = true;
  }
  for (int slot = 0; slot < budget_.slots; ++slot) {
    const HeldBody& held = held_[slot];
    if (held.number > 0 && !held.leaving && !stays[slot] && !mustStay(held)) leave(slot);
  }
  for (const int number : wanted) {
    Body& body = bodies_.at(number);
    if (body.slot >= 0) continue;
    const bool moves = body.spawn.owner != BodyOwner::kFixed;
    if (moves && movingNow(record) >= budget_.awake) continue;
    const int slot = freeOne(record);
    if (slot < 0) return;
    enter(body, slot);
  }
}

void BodyRegistry::enter(Body& body, int slot) {
  last_generation_ = last_generation_ < kLastGeneration ? last_generation_ + 1 : kFirstGeneration;
  SpawnOrder order = body.spawn;
  order.slot = slot;
  order.generation = last_generation_;
  const double speed_m_s = order.velocity_m_s.eigen().norm();
  if (speed_m_s > kMostSpawnSpeed_m_s) {
    const double share = 0.999 * kMostSpawnSpeed_m_s / speed_m_s;
    order.velocity_m_s = Vec3::from(share * order.velocity_m_s.eigen());
  }
  body.slot = slot;
  held_[slot] = HeldBody{};
  held_[slot].number = body.spawn.slot;
  held_[slot].generation = last_generation_;
  held_[slot].moves = order.owner != BodyOwner::kFixed;
  held_[slot].since_s = time_s_;
  for_loop_.push_back(spawnCommand(order));
  setWhereabouts(body, Whereabouts::kInSlot);
}

void BodyRegistry::leave(int slot) {
  HeldBody& held = held_[slot];
  held.leaving = true;
  held.since_s = time_s_;
  for_loop_.push_back(removeCommand(slot, held.generation));
}

}  // namespace wholehand
