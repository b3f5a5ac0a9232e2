#include "rig/registry/body_table.hpp"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <limits>
#include <utility>

namespace wholehand {
namespace {

/// An empty slot is below this height; bodies stay within 5 m.
constexpr double kParked_z_m = -8.0;
constexpr double kRefusedFor_s = 0.25;  ///< wait before a body that the loop refused is tried again
constexpr double kChoose_s = 0.02;
/// Silence of the holder after which the loop releases all bodies.
constexpr double kLeaves_s = 5.0;
/// Number of ticks within which the loop reports the result of a spawn.
constexpr std::uint64_t kAnsweredWithin = 1000;

bool fixed(BodyOwner owner) {
  return owner == BodyOwner::kFixed;
}

/// True for refusals that only a spawn can get.
bool refusesSpawn(BodyRefusal refusal) {
  return refusal == BodyRefusal::kSlotTaken || refusal == BodyRefusal::kNoSuchShapes ||
         refusal == BodyRefusal::kBadMass || refusal == BodyRefusal::kOverlap ||
         refusal == BodyRefusal::kBudget || refusal == BodyRefusal::kSilent;
}

// Constants for the choice of the bodies that get slots.
constexpr double kDriven_m_s = 0.5;  ///< largest speed of a body that the game moves
// Hysteresis of a slot. A body keeps its slot until it is kLateOut_m out of reach or another body
// is kNearer_m nearer, and at least kStays_s long and for kTouchStays_s after a touch.
constexpr double kLateOut_m = 0.1, kNearer_m = 0.05, kStays_s = 0.3, kTouchStays_s = 0.2;

}  // namespace

void BodyTable::begin(const HandModel& hand, const DeviceModel& device, const GameBudget& budget,
                      int first_body, const std::vector<std::string>& event_names) {
  follow(event_names);
  budget_ = budget;
  first_body_ = first_body;
  last_generation_ = kFirstGeneration;
  reach_ = std::make_unique<HandReach>(hand, device, kReachWithin_s);
}

void BodyTable::follow(const std::vector<std::string>& event_names) {
  end();
  static constexpr std::array<const char*, kEvents> kNames{"appeared", "solid", "letting_go",
                                                           "left", "refused"};
  for (std::size_t i = 0; i < kNames.size(); ++i) {
    const auto found = std::find(event_names.begin(), event_names.end(), kNames[i]);
    events_[i] = found == event_names.end() ? -1 : static_cast<int>(found - event_names.begin());
  }
}

void BodyTable::end() {
  for (auto& [number, body] : bodies_) {
    body.slot = -1;
    body.moved_away = false;
    body.not_before_s = 0.0;
    setWhereabouts(body, Whereabouts::kOutOfReach);
  }
  sets_ = {};
  slots_ = {};
  events_.fill(-1);
  for_loop_.clear();
  reach_.reset();
  tick_ = 0;
  time_s_ = chosen_s_ = 0.0;
  silent_since_s_ = -1.0;
  changed_ = false;
  in_slots_.reset();
}

void BodyTable::clear() {
  if (!bodies_.empty()) ++version_;
  bodies_.clear();
  for (Slot& slot : slots_) {
    if (slot.holder.number != 0) slot.holder.number = -1;
  }
}

bool BodyTable::isWaiting(const Slot& slot) const {
  return slot.next.generation != 0 && tick_ < slot.next.until_tick;
}

BodyTable::Body* BodyTable::find(int number) {
  const auto found = bodies_.find(number);
  return found == bodies_.end() ? nullptr : &found->second;
}

void BodyTable::setWhereabouts(Body& body, Whereabouts whereabouts) {
  if (body.whereabouts == whereabouts) return;
  body.whereabouts = whereabouts;
  ++version_;
}

bool BodyTable::isRegisteredSet(int set) const {
  return std::any_of(bodies_.begin(), bodies_.end(),
                     [&](const auto& at) { return at.second.spawn.shape_set == set; });
}

std::shared_ptr<const GameShapes> BodyTable::shapesOf(int set) const {
  return set >= 0 && set < kMaxShapeSets ? sets_[set] : nullptr;
}

RegisteredBodies BodyTable::registered() const {
  RegisteredBodies out;
  out.reserve(bodies_.size());
  for (const auto& [number, body] : bodies_) {
    const int slot = body.whereabouts == Whereabouts::kInSlot ? body.slot : -1;
    out.push_back(
        {number, body.spawn.generation, slot, body.whereabouts, body.spawn.pose, body.shapes});
  }
  return out;
}

// Orders.

BodyRefusal BodyTable::prepare(int set, std::shared_ptr<const GameShapes> shapes) {
  if (set < 0 || set >= kMaxShapeSets) return BodyRefusal::kNoSuchShapes;
  const auto has = [&](const Slot& slot) {
    return (slot.now.body.generation != 0 && slot.now.shape_set == set) ||
           (isWaiting(slot) && slot.next.shape_set == set);
  };
  if (isRegisteredSet(set) || std::any_of(slots_.begin(), slots_.end(), has)) {
    return BodyRefusal::kShapesBusy;
  }
  sets_[set] = std::move(shapes);
  return BodyRefusal::kNone;
}

void BodyTable::noteShapes(int set, std::shared_ptr<const GameShapes> shapes) {
  if (set >= 0 && set < kMaxShapeSets) sets_[set] = std::move(shapes);
}

BodyRefusal BodyTable::order(const Command& command) {
  const bool spawns = command.type == CommandType::kSpawn;
  if (isRegistered(command.index)) {
    return spawns ? add(spawnOrderOf(command)) : orderRegistered(command);
  }
  if (command.index < 0 || command.index >= kMaxSlots) return BodyRefusal::kNoSuchSlot;
  if (!spawns) return BodyRefusal::kNone;
  const SpawnOrder spawn = spawnOrderOf(command);
  if (holds(spawn.slot)) return BodyRefusal::kSlotTaken;
  slots_[spawn.slot].others_until_s = time_s_ + kAnswered_s;
  if (!shapesOf(spawn.shape_set)) return BodyRefusal::kNoSuchShapes;
  if (isWaiting(slots_[spawn.slot])) return BodyRefusal::kSlotTaken;
  noteSpawn(spawn);
  return BodyRefusal::kNone;
}

void BodyTable::noteSpawn(const SpawnOrder& spawn) {
  if (spawn.slot < 0 || spawn.slot >= kMaxSlots || !shapesOf(spawn.shape_set)) return;
  slots_[spawn.slot].others_until_s = time_s_ + kAnswered_s;
  expect(spawn.slot, spawn);
}

void BodyTable::expect(int index, const SpawnOrder& spawn) {
  slots_[index].next = {spawn.generation, spawn.shape_set, sets_[spawn.shape_set],
                        tick_ + kAnsweredWithin};
}

BodyRefusal BodyTable::add(const SpawnOrder& spawn) {
  auto shapes = shapesOf(spawn.shape_set);
  if (!shapes) return BodyRefusal::kNoSuchShapes;
  if (find(spawn.slot) != nullptr) return BodyRefusal::kSlotTaken;
  if (bodies_.size() >= std::size_t{kMostRegistered}) return BodyRefusal::kBudget;
  if (silent_since_s_ >= 0.0) return BodyRefusal::kSilent;
  Body body;
  body.spawn = spawn;
  body.spawn.refuse_overlap = false;
  body.shapes = std::move(shapes);
  bodies_.emplace(spawn.slot, std::move(body));
  ++version_;
  return BodyRefusal::kNone;
}

BodyRefusal BodyTable::orderRegistered(const Command& command) {
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

BodyRefusal BodyTable::orderInSlot(Body& body, const Command& command) {
  Slot& slot = slots_[body.slot];
  Slot::Holder& holder = slot.holder;
  if (holder.leaving) {  // the body is leaving its slot: the command applies after it has left
    if (command.type == CommandType::kRemove) holder.number = -1;
    const bool moves =
        command.type == CommandType::kTeleport || command.type == CommandType::kBodyTarget;
    body.moved_away = body.moved_away || moves;
    return BodyRefusal::kNone;
  }
  Command order = command;
  order.index = body.slot;
  order.value = holder.generation;
  if (command.type == CommandType::kSetOwner) {
    const bool moves = !fixed(spawnOrderOf(command).owner);
    const auto moving = std::count_if(slots_.begin(), slots_.end(), [](const Slot& s) {
      return s.holder.number != 0 && s.moves;
    });
    if (moves && !slot.moves && moving >= budget_.awake) return BodyRefusal::kBudget;
    slot.moves = slot.moves || moves;
  }
  if (command.type == CommandType::kRemove) {
    holder.number = -1;
    holder.leaving = true;
    holder.since_s = time_s_;
  }
  for_loop_.push_back(order);
  return BodyRefusal::kNone;
}

// Records.

void BodyTable::onRecord(const TickRecord& record) {
  tick_ = record.tick;
  time_s_ = record.time_s;
  for (int i = 0; i < record.exercise.event_count; ++i) take(record.exercise.events[i]);
  if (changed_) publish();
  if (reach_ == nullptr) return;
  const bool silent = any(record.faults & (Fault::kHolderSilent | Fault::kStopRequested));
  if (!silent) silent_since_s_ = -1.0;
  if (silent && silent_since_s_ < 0.0) silent_since_s_ = time_s_;
  if (silent && time_s_ - silent_since_s_ > kLeaves_s) clear();
  noteRecord(record);
  for (int slot = 0; slot < budget_.slots; ++slot) {
    if (holds(slot)) followSlot(slot, record);
  }
  if (silent || !for_loop_.empty() || time_s_ - chosen_s_ < kChoose_s) return;
  chosen_s_ = time_s_;
  if (!bodies_.empty()) choose(record);
}

void BodyTable::take(const ExerciseEvent& event) {
  const auto found = std::find(events_.begin(), events_.end(), static_cast<int>(event.type));
  if (found == events_.end() || event.index < 0 || event.index >= kMaxSlots) return;
  const auto what = static_cast<Event>(found - events_.begin());
  if (what != kRefused) return takeState(what, event.index, static_cast<int>(event.value));
  if (!refusesSpawn(static_cast<BodyRefusal>(static_cast<int>(event.value)))) return;
  Slot& slot = slots_[event.index];
  slot.next = Slot::Next{};
  if (holds(event.index) && !slot.holder.seen) freeSlot(event.index);
}

void BodyTable::takeState(Event what, int slot, int generation) {
  Slot::Now& now = slots_[slot].now;
  if (what == kLeft) {
    changed_ = changed_ || now.body.generation != 0;
    now = Slot::Now{};
    return;
  }
  Slot::Next& next = slots_[slot].next;
  if (what == kAppeared && next.generation == generation) {
    now = {next.shape_set, {slot, generation, SlotState::kGhost, std::move(next.shapes)}};
    next = Slot::Next{};
  }
  if (now.body.generation != generation) return;
  now.body.state = what == kAppeared ? SlotState::kGhost
                   : what == kSolid  ? SlotState::kSolid
                                     : SlotState::kLettingGo;
  changed_ = true;
}

void BodyTable::publish() {
  auto bodies = std::make_shared<GameBodies>();
  for (const Slot& slot : slots_) {
    if (slot.now.body.generation != 0) bodies->push_back(slot.now.body);
  }
  in_slots_ = std::move(bodies);
  changed_ = false;
}

// Notes which bodies of the game itself are fixed, and which bodies the hand touches.
void BodyTable::noteRecord(const TickRecord& record) {
  for (int i = 0; i < record.command_count; ++i) {
    const Command& command = record.commands[i];
    const bool relevant =
        command.type == CommandType::kSpawn || command.type == CommandType::kSetOwner;
    if (!relevant || command.index < 0 || command.index >= budget_.slots) continue;
    if (!holds(command.index)) slots_[command.index].moves = !fixed(spawnOrderOf(command).owner);
  }
  for (int i = 0; i < record.contact_count; ++i) {
    const int slot = record.contacts[i].body - first_body_;
    if (slot >= 0 && slot < budget_.slots) slots_[slot].holder.touched_s = time_s_;
  }
}

bool BodyTable::parked(int slot, const TickRecord& record) const {
  const int index = first_body_ + slot;
  return index >= record.body_count || record.bodies[index].position_m.z < kParked_z_m;
}

void BodyTable::freeSlot(int slot) {
  Slot::Holder& holder = slots_[slot].holder;
  if (Body* body = find(holder.number)) {
    body->slot = -1;
    body->moved_away = false;
    if (!holder.seen) body->not_before_s = time_s_ + kRefusedFor_s;
    setWhereabouts(*body, Whereabouts::kOutOfReach);
  }
  holder = Slot::Holder{};
}

void BodyTable::followSlot(int slot, const TickRecord& record) {
  Slot::Holder& holder = slots_[slot].holder;
  if (!parked(slot, record)) {
    if (!holder.seen) holder.since_s = time_s_;
    holder.seen = true;
    return keepState(slot, record.bodies[first_body_ + slot]);
  }
  if (!holder.seen) {
    if (time_s_ - holder.since_s < kAnswered_s) return;
    // The loop may still execute the spawn later, so the slot is cleared.
    for_loop_.push_back(removeCommand(slot, holder.generation));
  } else if (!holder.leaving && find(holder.number) != nullptr) {
    // The loop removed the body because it was too fast or outside the world.
    bodies_.erase(holder.number);
    ++version_;
  }
  freeSlot(slot);
}

void BodyTable::keepState(int slot, const BodyState& state) {
  Body* body = find(slots_[slot].holder.number);
  if (body == nullptr || body->moved_away) return;
  const Eigen::Vector3d moved = state.position_m.eigen() - body->spawn.pose.position_m.eigen();
  const bool stands = moved.isZero(0.0) && state.velocity_m_s.eigen().isZero(0.0);
  body->spawn.pose = {state.position_m, state.orientation_xyzw};
  if (stands && body->spawn.owner == BodyOwner::kLoop) return;  // a ghost has no velocity yet
  body->spawn.velocity_m_s = state.velocity_m_s;
  body->spawn.spin_rad_s = state.angular_velocity_rad_s;
}

bool BodyTable::mustStay(const Slot::Holder& holder) const {
  return !holder.seen || time_s_ - holder.since_s < kStays_s ||
         (holder.touched_s >= 0.0 && time_s_ - holder.touched_s < kTouchStays_s);
}

/// Rank for a slot: distance from the hand, minus kNearer_m for a body in a slot; none: out of
/// reach.
std::optional<double> BodyTable::rankOf(const Body& body) const {
  const bool in_slot = body.slot >= 0;
  double speed_m_s = 0.0;
  if (body.spawn.owner == BodyOwner::kLoop) speed_m_s = body.spawn.velocity_m_s.eigen().norm();
  if (body.spawn.owner == BodyOwner::kGame) speed_m_s = kDriven_m_s;
  const double margin_m = kReachWithin_s * speed_m_s + (in_slot ? kLateOut_m : 0.0);
  const HandReach::Distance at =
      reach_->to(body.spawn.pose.position_m.eigen(), body.shapes->radius_m, margin_m);
  if (at.missed_m > margin_m) return std::nullopt;
  return at.now_m - (in_slot ? kNearer_m : 0.0);
}

std::vector<BodyTable::Candidate> BodyTable::candidates() {
  std::vector<Candidate> out;
  for (auto& [number, body] : bodies_) {
    if (body.slot >= 0 && slots_[body.slot].holder.leaving) continue;
    if (body.slot >= 0 && mustStay(slots_[body.slot].holder)) {
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
int BodyTable::movingNow(const TickRecord& record) const {
  int moving = 0;
  for (int slot = 0; slot < budget_.slots; ++slot) {
    moving += slots_[slot].moves && (holds(slot) || !parked(slot, record)) ? 1 : 0;
  }
  return moving;
}

// Returns the free slot with the lowest index, because a state message contains the poses up to the
// last slot in use; -1: none.
int BodyTable::freeOne(const TickRecord& record) const {
  for (int slot = 0; slot < budget_.slots; ++slot) {
    const bool others = time_s_ < slots_[slot].others_until_s;
    if (!holds(slot) && !others && parked(slot, record)) return slot;
  }
  return -1;
}

void BodyTable::choose(const TickRecord& record) {
  reach_->look(record.q_s, record.theta);
  int slots = budget_.slots, moving = budget_.awake;
  for (int slot = 0; slot < budget_.slots; ++slot) {  // subtracts what the game itself put there
    if (holds(slot) || parked(slot, record)) continue;
    --slots;
    if (slots_[slot].moves) --moving;
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

void BodyTable::giveSlots(const std::vector<int>& wanted, const TickRecord& record) {
  std::array<bool, kMaxSlots> stays{};
  for (const int number : wanted) {
    const int slot = bodies_.at(number).slot;
    if (slot >= 0) stays[slot] = true;
  }
  for (int slot = 0; slot < budget_.slots; ++slot) {
    const Slot::Holder& holder = slots_[slot].holder;
    if (holder.number > 0 && !holder.leaving && !stays[slot] && !mustStay(holder)) leave(slot);
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

void BodyTable::enter(Body& body, int slot) {
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
  slots_[slot].holder = {body.spawn.slot, last_generation_, false, false, time_s_, -1.0};
  slots_[slot].moves = !fixed(order.owner);
  expect(slot, order);
  for_loop_.push_back(spawnCommand(order));
  setWhereabouts(body, Whereabouts::kInSlot);
}

void BodyTable::leave(int slot) {
  Slot::Holder& holder = slots_[slot].holder;
  holder.leaving = true;
  holder.since_s = time_s_;
  for_loop_.push_back(removeCommand(slot, holder.generation));
}

}  // namespace wholehand
