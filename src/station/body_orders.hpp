#pragma once

#include "server/backend.hpp"

#include <cstdint>
#include <map>
#include <memory>
#include <vector>

namespace wholehand {

/// What a message of a game comes to: commands for the loop, and the items that are refused.
struct CheckedOrders {
  std::vector<Command> commands;
  std::vector<RefusedItem> refused;
  std::map<int, int> item_of_slot;  ///< index in the message, of slots and registered bodies
  int shape_set = -1;               ///< of `shapes`
  std::shared_ptr<const GameShapes> shapes;  ///< that the commands hand over; null: none
};

/// Checks every number of a message against the scene's budget, and prepares shapes. An item that
/// is refused has no command; shapes are refused as a whole. Orders to registered bodies are among
/// the commands. Not real-time safe. Any thread.
/// @param shapes_id GameShapes::id of what it prepares
[[nodiscard]] CheckedOrders checkOrders(const BodyOrders& orders, const GameBudget& budget,
                                        std::uint32_t shapes_id);

/// Reply to a message some of whose items are refused; accepted when there are none.
[[nodiscard]] OrderReply replyFor(std::vector<RefusedItem> refused);

}  // namespace wholehand
