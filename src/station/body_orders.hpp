#pragma once

#include "vocabulary/backend.hpp"

#include <cstdint>
#include <map>
#include <memory>
#include <vector>

namespace wholehand {

/// Result of checking a game's message: commands for the loop, and the refused items.
struct CheckedOrders {
  std::vector<Command> commands;
  std::vector<RefusedItem> refused;
  std::map<int, int> item_of_slot;  ///< index in the message, by slot or number of a registered
                                    ///< body
  int shape_set = -1;               ///< set number of `shapes`
  std::shared_ptr<const GameShapes> shapes;  ///< prepared shapes that the commands hand over; null:
                                             ///< none
};

/// Checks every number of a message against the scene's budget, and prepares shapes. A refused item
/// has no command; shapes are refused as a whole. The commands include those for registered bodies.
/// Not real-time safe. Any thread.
/// @param shapes_id GameShapes::id for the prepared shapes
[[nodiscard]] CheckedOrders checkOrders(const BodyOrders& orders, const GameBudget& budget,
                                        std::uint32_t shapes_id);

/// Makes the reply to a message with refused items; accepted when `refused` is empty.
[[nodiscard]] OrderReply replyFor(std::vector<RefusedItem> refused);

}  // namespace wholehand
