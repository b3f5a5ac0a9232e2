// Bodies of a game beyond the slots of the loop. All with mutex_ held.
#include "station/station_core.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <chrono>

namespace wholehand {
namespace {

/// Most commands that the registry lets wait for the loop: an aim waits 8 ms for them at most.
constexpr std::size_t kMostAhead = 64;
constexpr auto kMovesEvery = std::chrono::milliseconds(50);

std::string reasonOf(OrderRefusal refusal, const Command& command) {
  switch (refusal) {
    case OrderRefusal::kSlotTaken:
      return fmt::format("body {} is registered already: remove it first", command.index);
    case OrderRefusal::kBudget:
      return command.type == CommandType::kSpawn
                 ? fmt::format("body {}: {} are registered, which is the most: remove some first",
                               command.index, kMostRegistered)
                 : fmt::format("body {}: as many bodies move as budget.awake allows",
                               command.index);
    case OrderRefusal::kNotTheGames:
      return fmt::format("body {}: a target is for bodies of owner Game", command.index);
    case OrderRefusal::kNoSuchShapes:
      return fmt::format("body {}: shape set {} was not prepared in this session: prepare it first",
                         command.index, spawnOrderOf(command).shape_set);
    case OrderRefusal::kSilent:
      return fmt::format("body {}: the game is silent", command.index);
    default:
      return fmt::format("body {}: no body of generation {:.0f} is registered", command.index,
                         command.value);
  }
}

}  // namespace

void Station::Core::beginRegistry() {
  const auto& names = models_.exercise->description().event_names;
  const auto found = std::find(names.begin(), names.end(), "refused");
  const auto refused = found == names.end() ? -1 : static_cast<int>(found - names.begin());
  registry_.begin(models_.hand, models_.device, models_.scene.game,
                  static_cast<int>(models_.scene.bodies.size()), refused);
}

// Takes the orders to registered bodies out of the message: they are not for the loop.
void Station::Core::orderRegistered(CheckedOrders& orders) {
  std::erase_if(orders.commands, [&](const Command& command) {
    if (orders.shapes || !isRegistered(command.index)) return false;
    OrderRefusal refusal = OrderRefusal::kNone;
    if (command.type == CommandType::kSpawn) {
      const SpawnOrder spawn = spawnOrderOf(command);
      const auto shapes = tracker_.shapesOf(spawn.shape_set);
      refusal = shapes ? registry_.add(spawn, shapes->radius_m) : OrderRefusal::kNoSuchShapes;
    } else {
      refusal = registry_.obey(command);
    }
    if (refusal != OrderRefusal::kNone) {
      orders.refused.push_back(
          {orders.item_of_slot[command.index], command.index, refusal, reasonOf(refusal, command)});
    }
    return true;
  });
  publishRegistered();
}

// A game that also names slots: none that a registered body has, and no shapes of one.
void Station::Core::keepSlotsApart(CheckedOrders& orders) {
  if (orders.shapes && registry_.usesShapes(orders.shape_set)) {
    orders.refused.push_back({0, -1, OrderRefusal::kShapesBusy,
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
        {orders.item_of_slot[command.index], command.index, OrderRefusal::kSlotTaken,
         fmt::format("slot {} holds a registered body: name another slot", command.index)});
    return true;
  });
}

// Telemetry thread.
void Station::Core::followRegistry(const TickRecord& record) {
  if (!live_) return;
  registry_.see(record);
  auto& waiting = registry_.forLoop();
  while (!waiting.empty() && live_->waitingCommands() < kMostAhead) {
    if (waiting.front().type == CommandType::kSpawn) tracker_.noteSpawn(waiting.front());
    if (!live_->tryCommand(waiting.front())) break;
    waiting.pop_front();
  }
  publishRegistered();
}

// Who is where is told at once; what only moves, 20 times a second.
void Station::Core::publishRegistered() {
  const StationClock::time_point now = StationClock::now();
  const bool moved = registry_.moves() != registered_moves_ && now - registered_at_ > kMovesEvery;
  if (registry_.version() == registered_version_ && !moved) return;
  registered_version_ = registry_.version();
  registered_moves_ = registry_.moves();
  registered_at_ = now;
  auto all = std::make_shared<RegisteredBodies>();
  for (const RegisteredBody& body : registry_.bodies()) {
    auto shapes = tracker_.shapesOf(body.shape_set);
    if (shapes) all->push_back({body, std::move(shapes)});
  }
  registered_ = std::move(all);
}

}  // namespace wholehand
