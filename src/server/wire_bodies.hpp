#pragma once

#include "core/expected.hpp"
#include "server/wire.hpp"
#include "wholehand_generated.h"

namespace wholehand::wire {

/// True for the orders that decodeBodies() reads.
[[nodiscard]] bool ordersBodies(protocol::Order type) noexcept;

/// Reads an order to a game's bodies. Refuses counts that no scene allows, and what a picture or a
/// shape cannot be made of. Numbers of a body are read as they are: whoever obeys checks them.
/// @pre ordersBodies(), and the message is verified
[[nodiscard]] Expected<ClientMessage> decodeBodies(const protocol::Command& command,
                                                   ClientMessage message);

}  // namespace wholehand::wire
