#pragma once

#include "core/real_time.hpp"
#include "core/tick_listener.hpp"
#include "patient/player.hpp"

#include <cstddef>

namespace wholehand {

/// Passes the commands and the record of every tick to a player, in the thread that ticks.
class ListeningPlayer final : public TickListener {
 public:
  /// @pre player outlives this
  explicit ListeningPlayer(Player& player) : player_(player) {}
  WHOLEHAND_RT void beforeTick(const TickRecord& record) noexcept override {
    for (int i = 0; i < record.command_count; ++i) {
      player_.command(record.commands[i]);
    }
  }
  WHOLEHAND_RT void afterTick(const TickRecord& record) noexcept override { player_.see(record); }

 private:
  Player& player_;
};

}  // namespace wholehand
