#pragma once

#include "patient/player.hpp"
#include "runtime/session.hpp"

namespace wholehand {

/// Shows a player what every tick came to.
class ListeningPlayer final : public TickListener {
 public:
  /// @pre player outlives this
  explicit ListeningPlayer(Player& player) : player_(player) {}
  WHOLEHAND_RT void beforeTick(const TickRecord&) noexcept override {}
  WHOLEHAND_RT void afterTick(const TickRecord& record) noexcept override { player_.see(record); }

 private:
  Player& player_;
};

}  // namespace wholehand
