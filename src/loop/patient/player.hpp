#pragma once

#include "loop/core/command.hpp"
#include "loop/core/real_time.hpp"
#include "loop/core/tick_record.hpp"

#include <cstdint>
#include <limits>

namespace wholehand {

/// Properties of the virtual patient who does an exercise.
struct PlayerTraits {
  std::uint64_t seed = 1;
  /// Fastest opening of the hand that the virtual patient intends [rad/s]; see
  /// reflexFreeOpeningSpeed().
  double opening_rad_s = std::numeric_limits<double>::infinity();
};

/// Source of the hand's target, tick by tick: a script, a virtual patient who does an exercise, or
/// a person at the screen. Deterministic except for commands.
class Player {
 public:
  virtual ~Player() = default;

  /// Initial pose of the hand. Called before the device is opened.
  [[nodiscard]] virtual AxisPosition start() const = 0;

  /// Resets to the start. Not real-time safe.
  virtual void reset() = 0;

  /// Target one period later: position and velocity, continuous.
  WHOLEHAND_RT virtual void advance(double period_s, AxisPosition& q,
                                    AxisVelocity& qd) noexcept = 0;

  /// The mover that decides the target.
  [[nodiscard]] WHOLEHAND_RT virtual Mover mover() const noexcept { return Mover::kVirtualPatient; }
  /// Help that a page gives to the person who decides the target.
  [[nodiscard]] WHOLEHAND_RT virtual Help help() const noexcept { return Help::kUnspecified; }

  /// Receives a command before the tick that takes it, in the thread that ticks.
  WHOLEHAND_RT virtual void command(const Command&) noexcept {}

  /// Receives the record after each tick. A player whose advance() was not called since the last
  /// record does not steer the hand. The hand then follows `record.intention`, which another source
  /// set, and a player that decides by what it sees continues from there.
  WHOLEHAND_RT virtual void onRecord(const TickRecord& record) noexcept = 0;
};

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
  WHOLEHAND_RT void afterTick(const TickRecord& record) noexcept override {
    player_.onRecord(record);
  }

 private:
  Player& player_;
};

}  // namespace wholehand
