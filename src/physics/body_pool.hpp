#pragma once

#include "core/body_order.hpp"
#include "core/real_time.hpp"

namespace wholehand {

/// The bodies of a game in a physics world: a pool of slots that exist from the start
/// (docs/adr/0043-bodies-of-a-game.md). An engine that has one implements it beside PhysicsWorld.
/// Every function is real-time safe and deterministic: the same commands in the same ticks give the
/// same bits.
class BodyPool {
 public:
  virtual ~BodyPool() = default;

  /// Obeys one command, before a step; commands that are no body orders are ignored. An order that
  /// cannot be carried out changes nothing and stands in the next report().
  WHOLEHAND_RT virtual void obey(const Command& command) noexcept = 0;
  /// Says whether the game is alive; call before every step. While it is silent, the force of
  /// driven bodies fades within 0.2 s; after 5 s all bodies of the game leave.
  WHOLEHAND_RT virtual void setGameAlive(bool alive) noexcept = 0;
  /// Reports the slots, and the orders refused since the last report.
  WHOLEHAND_RT virtual void report(PoolReport& report) noexcept = 0;
};

}  // namespace wholehand
