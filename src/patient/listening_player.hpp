#pragma once

#include "core/real_time.hpp"
#include "core/tick_listener.hpp"
#include "patient/player.hpp"

namespace wholehand {

/// Shows a player what every tick came to, in the thread that ticks.
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
