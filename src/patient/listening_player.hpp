#pragma once

#include "core/real_time.hpp"
#include "core/tick_listener.hpp"
#include "patient/player.hpp"

#include <cstddef>

namespace wholehand {

/// Tells a player what is asked of every tick and what it came to, in the thread that ticks.
class ListeningPlayer final : public TickListener {
 public:
  /// @pre player outlives this
  explicit ListeningPlayer(Player& player) : player_(player) {}
  WHOLEHAND_RT void beforeTick(const TickRecord& record) noexcept override {
    for (int i = 0; i < record.command_count; ++i) {
      player_.command(record.commands[static_cast<std::size_t>(i)]);
    }
  }
  WHOLEHAND_RT void afterTick(const TickRecord& record) noexcept override { player_.see(record); }

 private:
  Player& player_;
};

}  // namespace wholehand
