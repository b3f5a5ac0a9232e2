#include "station/game_body_tracker.hpp"

#include <fmt/format.h>

#include <algorithm>

namespace wholehand {
namespace {

/// Ticks within which the loop says what became of a spawn.
constexpr std::uint64_t kAnsweredWithin = 1000;

/// Refusals that only a spawn meets.
bool endsSpawn(BodyRefusal refusal) {
  return refusal == BodyRefusal::kSlotTaken || refusal == BodyRefusal::kNoSuchShapes ||
         refusal == BodyRefusal::kBadMass || refusal == BodyRefusal::kOverlap ||
         refusal == BodyRefusal::kBudget || refusal == BodyRefusal::kSilent;
}

}  // namespace

void GameBodyTracker::reset(const std::vector<std::string>& event_names) {
  static constexpr std::array<const char*, kEvents> kNames{"appeared", "solid", "letting_go",
                                                           "left", "refused"};
  const std::lock_guard lock(mutex_);
  for (std::size_t i = 0; i < kNames.size(); ++i) {
    const auto found = std::find(event_names.begin(), event_names.end(), kNames[i]);
    types_[i] = found == event_names.end() ? -1 : static_cast<int>(found - event_names.begin());
  }
  tick_ = 0;
  sets_ = {};
  pending_ = {};
  present_ = {};
  changed_ = false;
  bodies_.reset();
}

bool GameBodyTracker::inUse(int shape_set) const {
  for (int slot = 0; slot < kMaxSlots; ++slot) {
    if (present_[slot].generation != 0 && present_[slot].shape_set == shape_set) return true;
    const Pending& pending = pending_[slot];
    if (pending.generation != 0 && pending.shape_set == shape_set && tick_ < pending.until_tick) {
      return true;
    }
  }
  return false;
}

void GameBodyTracker::refuseBusy(CheckedOrders& orders) {
  const std::lock_guard lock(mutex_);
  if (orders.shapes && inUse(orders.shape_set)) {
    orders.refused.push_back(
        {0, -1, BodyRefusal::kShapesBusy,
         fmt::format("shape set {} belongs to a body in the world: remove the body first, or use "
                     "another set",
                     orders.shape_set)});
    orders.commands.clear();
    orders.shapes.reset();
    return;
  }
  const auto refused = [&](const Command& command) {
    if (command.type != CommandType::kSpawn) return false;
    const Pending& pending = pending_[command.index];
    const SpawnOrder spawn = spawnOrderOf(command);
    const bool unknown = !sets_[spawn.shape_set];
    const bool under_way = pending.generation != 0 && tick_ < pending.until_tick;
    if (!unknown && !under_way) return false;
    orders.refused.push_back(
        {orders.item_of_slot[command.index], command.index,
         unknown ? BodyRefusal::kNoSuchShapes : BodyRefusal::kSlotTaken,
         unknown
             ? fmt::format("shape set {} was not prepared in this session: prepare it first",
                           spawn.shape_set)
             : fmt::format("slot {} has a spawn under way: wait for its event", command.index)});
    return true;
  };
  orders.commands.erase(std::remove_if(orders.commands.begin(), orders.commands.end(), refused),
                        orders.commands.end());
}

void GameBodyTracker::note(const CheckedOrders& orders) {
  const std::lock_guard lock(mutex_);
  if (orders.shapes) sets_[orders.shape_set] = orders.shapes;
  for (const Command& command : orders.commands) {
    if (command.type == CommandType::kSpawn) expect(spawnOrderOf(command));
  }
}

void GameBodyTracker::noteSpawn(const Command& spawn) {
  const std::lock_guard lock(mutex_);
  expect(spawnOrderOf(spawn));
}

void GameBodyTracker::expect(const SpawnOrder& spawn) {
  pending_[spawn.slot] = {spawn.generation, spawn.shape_set, sets_[spawn.shape_set],
                          tick_ + kAnsweredWithin};
}

std::shared_ptr<const GameShapes> GameBodyTracker::shapesOf(int shape_set) const {
  const std::lock_guard lock(mutex_);
  return sets_[shape_set];
}

void GameBodyTracker::withdraw(int slot) {
  const std::lock_guard lock(mutex_);
  pending_[slot] = Pending{};
}

void GameBodyTracker::see(const TickRecord& record) {
  const std::lock_guard lock(mutex_);
  tick_ = record.tick;
  for (int i = 0; i < record.exercise.event_count; ++i) take(record.exercise.events[i]);
  if (changed_) publish();
}

void GameBodyTracker::take(const ExerciseEvent& event) {
  const auto found = std::find(types_.begin(), types_.end(), static_cast<int>(event.type));
  if (found == types_.end() || event.index < 0 || event.index >= kMaxSlots) return;
  const auto what = static_cast<Event>(found - types_.begin());
  if (what != kRefused) return takeState(what, event.index, static_cast<int>(event.value));
  if (endsSpawn(static_cast<BodyRefusal>(static_cast<int>(event.value)))) {
    pending_[event.index] = Pending{};
  }
}

void GameBodyTracker::takeState(Event what, int slot, int generation) {
  Present& present = present_[slot];
  if (what == kLeft) {
    changed_ = changed_ || present.generation != 0;
    present = Present{};
    return;
  }
  Pending& pending = pending_[slot];
  if (what == kAppeared && pending.generation == generation) {
    present = {generation,
               pending.shape_set,
               {slot, generation, SlotState::kGhost, std::move(pending.shapes)}};
    pending = Pending{};
  }
  if (present.generation != generation) return;
  present.body.state = what == kAppeared ? SlotState::kGhost
                       : what == kSolid  ? SlotState::kSolid
                                         : SlotState::kLettingGo;
  changed_ = true;
}

void GameBodyTracker::publish() {
  auto bodies = std::make_shared<GameBodies>();
  for (const Present& present : present_) {
    if (present.generation != 0) bodies->push_back(present.body);
  }
  bodies_ = std::move(bodies);
  changed_ = false;
}

std::shared_ptr<const GameBodies> GameBodyTracker::bodies() const {
  const std::lock_guard lock(mutex_);
  return bodies_;
}

}  // namespace wholehand
