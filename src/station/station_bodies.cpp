// Orders of a game to its bodies: checked here, handed to the loop. Any thread.
#include "station/station_core.hpp"

#include <fmt/format.h>

namespace wholehand {
namespace {

/// Most commands of bodies that wait for the loop: the shapes of one body with the most pieces and
/// vertices. The loop takes eight in a tick, so that an aim waits for 36 ms at most.
constexpr std::size_t kMostWaiting = 288;

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
  return handOver(checked);
}

// All commands of a message, or none: a set of shapes must not arrive in part.
OrderReply Station::Core::handOver(CheckedOrders& checked) {
  if (!live_) {
    return refused(Refusal::kNothingArmed,
                   "nothing is armed: arm, then prepare shapes and spawn again");
  }
  if (status_.run_state != RunState::kRendering) {
    return refused(Refusal::kStillStopping,
                   "the loop stops: arm again, then prepare shapes and spawn again");
  }
  tracker_.refuseBusy(checked);
  if (checked.commands.size() + live_->waitingCommands() > kMostWaiting) {
    return refused(Refusal::kBusy,
                   fmt::format("{} commands wait for the loop already, at most {} may: nothing of "
                               "this message was handed over; say it again",
                               live_->waitingCommands(), kMostWaiting));
  }
  tracker_.note(checked);
  for (const Command& command : checked.commands) {
    if (OrderReply pushed = push(command); !pushed.accepted) return pushed;  // there was room
  }
  return replyFor(std::move(checked.refused));
}

}  // namespace wholehand
