// Orders of a game to its bodies: checked here, handed to the loop. Any thread.
#include "station/station_core.hpp"

#include <fmt/format.h>

#include <algorithm>

namespace wholehand {
namespace {

/// Most commands of bodies that wait for the loop: the shapes of one body with the most pieces and
/// vertices. The loop takes eight in a tick, so that an aim waits for 36 ms at most.
constexpr std::size_t kMostWaiting = 288;

OrderReply busy(std::size_t waiting, const char* where) {
  return refused(Refusal::kBusy,
                 fmt::format("{} commands wait for {} already, at most {} may: nothing of this "
                             "message was handed over; say it again",
                             waiting, where, kMostWaiting));
}

/// Commands that are not for the registry.
std::size_t forLoop(const CheckedOrders& orders) {
  const auto for_loop = [&](const Command& command) {
    return orders.shapes || !isRegistered(command.index);
  };
  return std::count_if(orders.commands.begin(), orders.commands.end(), for_loop);
}

}  // namespace

// Numbers are checked and shapes prepared before any lock is taken.
OrderReply Station::Core::orderBodies(const Order& order) {
  const GameBudget budget = scene()->scene.game;
  if (budget.slots == 0) {
    return refused(
        Refusal::kNoBodies,
        "this scene takes no bodies of a game: load an exercise whose file has [budget], "
        "as game-scene");
  }
  CheckedOrders checked = checkOrders(*order.bodies, budget);
  const std::lock_guard lock(mutex_);
  ++orders_;
  if (superseded(order)) {
    return refused(Refusal::kNotHolder, "another client holds the controls by now");
  }
  return live_ ? handOver(checked) : keep(checked, order.claim);
}

// Shapes and spawns wait for the next arming. mutex_ held, no session.
OrderReply Station::Core::keep(CheckedOrders& checked, std::uint32_t claim) {
  if (claim != kept_claim_) dropKept();
  kept_claim_ = claim;
  for (const Command& command : checked.commands) {
    if (checked.shapes || command.type == CommandType::kSpawn ||
        command.type == CommandType::kRemove) {
      continue;
    }
    return refused(Refusal::kNothingArmed,
                   "nothing is armed: shapes and spawns are kept for the next arming, and Remove "
                   "takes a kept spawn back; arm before anything else");
  }
  std::erase_if(checked.commands, [&](const Command& command) {
    if (command.type != CommandType::kRemove || isRegistered(command.index)) return false;
    if (!takeBack(command)) {
      checked.refused.push_back(
          {checked.item_of_slot[command.index], command.index, OrderRefusal::kWrongGeneration,
           fmt::format("slot {}: no spawn of generation {:.0f} is kept for the next arming",
                       command.index, command.value)});
    }
    return true;
  });
  std::size_t waiting = 0;
  for (const CheckedOrders& kept : kept_) waiting += kept.commands.size();
  if (forLoop(checked) + waiting > kMostWaiting) return busy(waiting, "the next arming");
  orderRegistered(checked);
  keepSlotsApart(checked);
  tracker_.refuseBusy(checked);
  tracker_.note(checked);
  OrderReply reply = replyFor(std::move(checked.refused));
  if (!checked.commands.empty()) kept_.push_back(std::move(checked));
  return reply;
}

bool Station::Core::takeBack(const Command& removal) {
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

void Station::Core::dropKept() {
  if (!kept_.empty()) tracker_.reset();
  kept_.clear();
  registry_.clear();
  publishRegistered();
}

// Into the empty queue of a session that begins. They are forgotten once it runs.
void Station::Core::handOverKept() {
  if (kept_claim_ != claim_) {  // of an earlier holder of the controls
    kept_.clear();
    registry_.clear();
  }
  for (const CheckedOrders& kept : kept_) {
    tracker_.note(kept);
    for (const Command& command : kept.commands) {
      if (command.type == CommandType::kSpawn) registry_.leaveToOthers(command.index);
      (void)push(command);  // there is room
    }
  }
}

// All commands of a message, or none: a set of shapes must not arrive in part.
OrderReply Station::Core::handOver(CheckedOrders& checked) {
  if (status_.run_state != RunState::kRendering) {
    return refused(Refusal::kStillStopping,
                   "the loop stops: arm again, then prepare shapes and spawn again");
  }
  if (forLoop(checked) + live_->waitingCommands() > kMostWaiting) {
    return busy(live_->waitingCommands(), "the loop");
  }
  orderRegistered(checked);
  keepSlotsApart(checked);
  tracker_.refuseBusy(checked);
  tracker_.note(checked);
  for (const Command& command : checked.commands) {
    if (OrderReply pushed = push(command); !pushed.accepted) return pushed;  // there was room
  }
  return replyFor(std::move(checked.refused));
}

}  // namespace wholehand
