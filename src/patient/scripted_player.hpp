#pragma once

#include "patient/motion.hpp"
#include "patient/player.hpp"

#include <cstdint>

namespace wholehand {

/// Plays an intention by time, regardless of the hand. Time is counted in periods, so that a
/// skipped and a waited period give the same bits.
class ScriptedPlayer final : public Player {
 public:
  /// @param mover kMotion, or kNobody when the intention is to rest
  explicit ScriptedPlayer(Intention intention, Mover mover = Mover::kMotion);

  [[nodiscard]] AxisPosition start() const override;
  void reset() override { periods_ = 0; }
  /// @pre the same period as in every other call since reset()
  WHOLEHAND_RT void advance(double period_s, AxisPosition& q, AxisVelocity& qd) noexcept override;
  WHOLEHAND_RT void see(const TickRecord&) noexcept override {}
  [[nodiscard]] WHOLEHAND_RT Mover mover() const noexcept override { return mover_; }

 private:
  Intention intention_;
  Mover mover_;
  std::int64_t periods_ = 0;
};

}  // namespace wholehand
