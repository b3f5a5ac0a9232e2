#include "station/station_bodies.hpp"

#include "loop/core/body_order.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <string>
#include <utility>

namespace wholehand {
namespace {

/// Largest number of body commands that wait for the loop: enough for the shapes of one body with
/// the most pieces and vertices. The loop takes eight commands in a tick, so an aim waits 36 ms at
/// most.
constexpr std::size_t kMostWaiting = 288;

OrderReply busy(std::size_t waiting, const char* where) {
  return refused(Refusal::kBusy,
                 fmt::format("{} commands wait for {} already, at most {} may: nothing of this "
                             "message was handed over; say it again",
                             waiting, where, kMostWaiting));
}

/// Number of commands that are for the loop and not for the registry.
std::size_t forLoop(const CheckedOrders& orders) {
  const auto for_loop = [&](const Command& command) {
    return orders.shapes || !isRegistered(command.index);
  };
  return std::count_if(orders.commands.begin(), orders.commands.end(), for_loop);
}

/// Largest number of registry commands that wait for the loop: an aim waits 8 ms for them at most.
constexpr std::size_t kMostAhead = 64;
constexpr auto kMovesEvery = std::chrono::milliseconds(50);

std::string reasonOf(BodyRefusal refusal, const Command& command, const BodyTable& table) {
  const bool registered = isRegistered(command.index);
  const std::string who = fmt::format("{} {}", registered ? "body" : "slot", command.index);
  switch (refusal) {
    case BodyRefusal::kSlotTaken:
      if (registered) return who + " is registered already: remove it first";
      return table.holds(command.index) ? who + " holds a registered body: name another slot"
                                        : who + " has a spawn under way: wait for its event";
    case BodyRefusal::kBudget:
      return command.type == CommandType::kSpawn
                 ? fmt::format("{}: {} are registered, which is the most: remove some first", who,
                               kMostRegistered)
                 : who + ": as many bodies move as budget.awake allows";
    case BodyRefusal::kNotTheGames:
      return who + ": a target is for bodies of owner Game";
    case BodyRefusal::kNoSuchShapes:
      return fmt::format("{}shape set {} was not prepared in this session: prepare it first",
                         registered ? who + ": " : "", spawnOrderOf(command).shape_set);
    case BodyRefusal::kSilent:
      return who + ": the game is silent";
    default:
      return fmt::format("{}: no body of generation {:.0f} is registered", who, command.value);
  }
}

}  // namespace

void StationBodies::begin(const Models& models, Run& loop, std::uint32_t claim) {
  table_.end();
  if (models.scene.game.slots == 0) return;
  table_.begin(models.hand, models.device, models.scene.game,
               static_cast<int>(models.scene.bodies.size()),
               models.exercise->description().event_names);
  loop_ = &loop;
  if (kept_claim_ != claim) {  // they came from an earlier holder of the controls
    kept_.clear();
    table_.clear();
  }
  noteKept();
  for (const CheckedOrders& kept : kept_) {  // the queue of a new session has room
    for (const Command& command : kept.commands) (void)loop.tryCommand(command);
  }
}

void StationBodies::noteKept() {
  for (const CheckedOrders& kept : kept_) {
    if (kept.shapes) table_.noteShapes(kept.shape_set, kept.shapes);
    for (const Command& command : kept.commands) {
      if (command.type == CommandType::kSpawn) table_.noteSpawn(spawnOrderOf(command));
    }
  }
}

void StationBodies::giveBack() {
  loop_ = nullptr;
  table_.end();
  noteKept();
}

void StationBodies::end() {
  loop_ = nullptr;
  table_.end();
  table_.clear();
  publish();
}

void StationBodies::dropKept() {
  if (!kept_.empty()) table_.end();
  kept_.clear();
  table_.clear();
  publish();
}

OrderReply StationBodies::keep(CheckedOrders& orders, std::uint32_t claim) {
  if (claim != kept_claim_) dropKept();
  kept_claim_ = claim;
  const auto waits = [&](const Command& command) {
    return orders.shapes || command.type == CommandType::kSpawn ||
           command.type == CommandType::kRemove;
  };
  if (!std::all_of(orders.commands.begin(), orders.commands.end(), waits)) {
    return refused(Refusal::kNothingArmed,
                   "nothing is armed: shapes and spawns are kept for the next arming, and Remove "
                   "takes a kept spawn back; arm before anything else");
  }
  takeBack(orders);
  std::size_t waiting = 0;
  for (const CheckedOrders& kept : kept_) waiting += kept.commands.size();
  OrderReply reply = take(orders, waiting, "the next arming");
  if (reply.accepted) reply.reason = "nothing is armed: kept for the next arming";
  if (!orders.commands.empty()) kept_.push_back(std::move(orders));
  return reply;
}

OrderReply StationBodies::handOver(CheckedOrders& orders) {
  if (loop_ == nullptr) {  // the orders were checked against the previous scene
    return refused(Refusal::kNoBodies, "another scene was loaded meanwhile, without such bodies");
  }
  OrderReply reply = take(orders, loop_->waitingCommands(), "the loop");
  for (const Command& command : orders.commands) {
    if (!loop_->tryCommand(command)) return busy(loop_->waitingCommands(), "the loop");
  }
  return reply;
}

// Removes from `orders` what the table refuses and what it keeps; the rest is for the loop. When
// too many commands wait already, all are removed.
OrderReply StationBodies::take(CheckedOrders& orders, std::size_t waiting, const char* where) {
  if (forLoop(orders) + waiting > kMostWaiting) {
    orders.commands.clear();
    return busy(waiting, where);
  }
  const auto refuse = [&](const Command& command) {
    const BodyRefusal refusal = table_.order(command);
    if (refusal != BodyRefusal::kNone) {
      orders.refused.push_back({orders.item_of_slot[command.index], command.index, refusal,
                                reasonOf(refusal, command, table_)});
    }
    return refusal != BodyRefusal::kNone || isRegistered(command.index);
  };
  if (orders.shapes) {
    prepare(orders);
  } else {
    std::erase_if(orders.commands, refuse);
  }
  publish();
  return replyFor(std::move(orders.refused));
}

void StationBodies::prepare(CheckedOrders& orders) {
  const bool registered = table_.isRegisteredSet(orders.shape_set);
  const BodyRefusal refusal = table_.prepare(orders.shape_set, orders.shapes);
  if (refusal == BodyRefusal::kNone) return;
  orders.refused.push_back(
      {0, -1, refusal,
       fmt::format("shape set {} belongs to a {}: remove the body first, or use another set",
                   orders.shape_set, registered ? "registered body" : "body in the world")});
  orders.commands.clear();
  orders.shapes.reset();
}

void StationBodies::takeBack(CheckedOrders& orders) {
  std::erase_if(orders.commands, [&](const Command& command) {
    if (command.type != CommandType::kRemove || isRegistered(command.index)) return false;
    if (!takeBack(command)) {
      orders.refused.push_back(
          {orders.item_of_slot[command.index], command.index, BodyRefusal::kWrongGeneration,
           fmt::format("slot {}: no spawn of generation {:.0f} is kept for the next arming",
                       command.index, command.value)});
    }
    return true;
  });
}

bool StationBodies::takeBack(const Command& removal) {
  for (CheckedOrders& kept : kept_) {
    const auto erased = std::erase_if(kept.commands, [&](const Command& command) {
      return command.type == CommandType::kSpawn && command.index == removal.index &&
             command.value == removal.value;
    });
    if (erased == 0) continue;
    table_.withdraw(removal.index);
    return true;
  }
  return false;
}

void StationBodies::onRecord(const TickRecord& record) {
  table_.onRecord(record);
  if (loop_ == nullptr) return;
  auto& waiting = table_.forLoop();
  while (!waiting.empty() && loop_->waitingCommands() < kMostAhead) {
    if (!loop_->tryCommand(waiting.front())) break;
    waiting.pop_front();
  }
  publish();
}

// Publishes a change of place or state at once, and mere motion 20 times a second.
void StationBodies::publish() {
  const Clock::time_point now = Clock::now();
  const bool moved = table_.moves() != published_moves_ && now - published_at_ > kMovesEvery;
  if (table_.version() == published_version_ && !moved) return;
  published_version_ = table_.version();
  published_moves_ = table_.moves();
  published_at_ = now;
  registered_ = std::make_shared<const RegisteredBodies>(table_.registered());
}

}  // namespace wholehand
