#pragma once

#include "core/command.hpp"
#include "core/real_time.hpp"
#include "core/tick_record.hpp"

namespace wholehand {

/// Where somebody wants the hand to be, decided tick by tick: a script, a virtual patient who does
/// an exercise, a person at the screen. Deterministic but for commands.
class Player {
 public:
  virtual ~Player() = default;

  /// Where the hand is before anything happens. Called before the device is opened.
  [[nodiscard]] virtual AxisPosition start() const = 0;

  /// Back to the start. Not real-time safe.
  virtual void reset() = 0;

  /// The aim one period later: position and velocity, continuous.
  WHOLEHAND_RT virtual void advance(double period_s, AxisPosition& q,
                                    AxisVelocity& qd) noexcept = 0;

  /// What somebody asks of the loop, before the tick that takes it. In the thread that ticks.
  WHOLEHAND_RT virtual void command(const Command&) noexcept {}

  /// What a tick came to; called after each. A player that was not asked to advance() since the
  /// last one does not steer: somebody else has the hand where `record.intention` says, and a
  /// player that decides by what it sees goes on from there.
  WHOLEHAND_RT virtual void see(const TickRecord& record) noexcept = 0;
};

}  // namespace wholehand
