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

std::string reasonOf(BodyRefusal refusal, const Command& command) {
  switch (refusal) {
    case BodyRefusal::kSlotTaken:
      return fmt::format("body {} is registered already: remove it first", command.index);
    case BodyRefusal::kBudget:
      return command.type == CommandType::kSpawn
                 ? fmt::format("body {}: {} are registered, which is the most: remove some first",
                               command.index, kMostRegistered)
                 : fmt::format("body {}: as many bodies move as budget.awake allows",
                               command.index);
    case BodyRefusal::kNotTheGames:
      return fmt::format("body {}: a target is for bodies of owner Game", command.index);
    case BodyRefusal::kNoSuchShapes:
      return fmt::format("body {}: shape set {} was not prepared in this session: prepare it first",
                         command.index, spawnOrderOf(command).shape_set);
    case BodyRefusal::kSilent:
      return fmt::format("body {}: the game is silent", command.index);
    default:
      return fmt::format("body {}: no body of generation {:.0f} is registered", command.index,
                         command.value);
  }
}

}  // namespace

void StationBodies::begin(const Models& models, Run& loop, std::uint32_t claim) {
  if (models.scene.game.slots == 0) return tracker_.reset();
  tracker_.reset(models.exercise->description().event_names);
  registry_.begin(models.hand, models.device, models.scene.game,
                  static_cast<int>(models.scene.bodies.size()), tracker_.refusedEvent());
  loop_ = &loop;
  if (kept_claim_ != claim) {  // they came from an earlier holder of the controls
    kept_.clear();
    registry_.clear();
  }
  for (const CheckedOrders& kept : kept_) {
    tracker_.note(kept);
    for (const Command& command : kept.commands) {
      if (command.type == CommandType::kSpawn) registry_.leaveToOthers(command.index);
      (void)loop.tryCommand(command);  // the queue of a new session has room
    }
  }
}

void StationBodies::giveBack() {
  loop_ = nullptr;
  tracker_.reset();
  for (const CheckedOrders& kept : kept_) tracker_.note(kept);
  registry_.end();
}

void StationBodies::end() {
  loop_ = nullptr;
  tracker_.reset();
  registry_.end();
  registry_.clear();
  publish();
}

void StationBodies::dropKept() {
  if (!kept_.empty()) tracker_.reset();
  kept_.clear();
  registry_.clear();
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

// Removes from `orders` the refused commands and those for the registry; the rest is for the loop.
// When too many commands wait already, all are removed.
OrderReply StationBodies::take(CheckedOrders& orders, std::size_t waiting, const char* where) {
  if (forLoop(orders) + waiting > kMostWaiting) {
    orders.commands.clear();
    return busy(waiting, where);
  }
  orderRegistered(orders);
  keepSlotsApart(orders);
  tracker_.refuseBusy(orders);
  tracker_.note(orders);
  return replyFor(std::move(orders.refused));
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
    tracker_.withdraw(removal.index);
    return true;
  }
  return false;
}

// Removes the orders to registered bodies from the message and hands them to the registry.
void StationBodies::orderRegistered(CheckedOrders& orders) {
  std::erase_if(orders.commands, [&](const Command& command) {
    if (orders.shapes || !isRegistered(command.index)) return false;
    BodyRefusal refusal = BodyRefusal::kNone;
    if (command.type == CommandType::kSpawn) {
      const SpawnOrder spawn = spawnOrderOf(command);
      const auto shapes = tracker_.shapesOf(spawn.shape_set);
      refusal = shapes ? registry_.add(spawn, shapes->radius_m) : BodyRefusal::kNoSuchShapes;
    } else {
      refusal = registry_.apply(command);
    }
    if (refusal != BodyRefusal::kNone) {
      orders.refused.push_back(
          {orders.item_of_slot[command.index], command.index, refusal, reasonOf(refusal, command)});
    }
    return true;
  });
  publish();
}

// Applies to games that name slots themselves: refuses slots of registered bodies, and shape sets
// that registered bodies use.
void StationBodies::keepSlotsApart(CheckedOrders& orders) {
  if (orders.shapes && registry_.usesShapes(orders.shape_set)) {
    orders.refused.push_back({0, -1, BodyRefusal::kShapesBusy,
                              fmt::format("shape set {} belongs to a registered body: remove the "
                                          "body first, or use another set",
                                          orders.shape_set)});
    orders.commands.clear();
    orders.shapes.reset();
    return;
  }
  std::erase_if(orders.commands, [&](const Command& command) {
    if (command.type != CommandType::kSpawn) return false;
    if (!registry_.holds(command.index)) {
      registry_.leaveToOthers(command.index);
      return false;
    }
    orders.refused.push_back(
        {orders.item_of_slot[command.index], command.index, BodyRefusal::kSlotTaken,
         fmt::format("slot {} holds a registered body: name another slot", command.index)});
    return true;
  });
}

void StationBodies::onRecord(const TickRecord& record) {
  tracker_.onRecord(record);
  if (loop_ == nullptr) return;
  registry_.onRecord(record);
  auto& waiting = registry_.forLoop();
  while (!waiting.empty() && loop_->waitingCommands() < kMostAhead) {
    if (waiting.front().type == CommandType::kSpawn) tracker_.noteSpawn(waiting.front());
    if (!loop_->tryCommand(waiting.front())) break;
    waiting.pop_front();
  }
  publish();
}

// Publishes a change of place or state at once, and mere motion 20 times a second.
void StationBodies::publish() {
  const Clock::time_point now = Clock::now();
  const bool moved = registry_.moves() != published_moves_ && now - published_at_ > kMovesEvery;
  if (registry_.version() == published_version_ && !moved) return;
  published_version_ = registry_.version();
  published_moves_ = registry_.moves();
  published_at_ = now;
  auto all = std::make_shared<RegisteredBodies>();
  for (const RegisteredBody& body : registry_.bodies()) {
    auto shapes = tracker_.shapesOf(body.shape_set);
    if (shapes) all->push_back({body, std::move(shapes)});
  }
  registered_ = std::move(all);
}

}  // namespace wholehand
