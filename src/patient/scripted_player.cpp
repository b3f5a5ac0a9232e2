#include "patient/scripted_player.hpp"

#include <utility>

namespace wholehand {

ScriptedPlayer::ScriptedPlayer(Intention intention, Mover mover)
    : intention_(std::move(intention)), mover_(mover) {}

AxisPosition ScriptedPlayer::start() const {
  return intention_.start();
}

void ScriptedPlayer::advance(double period_s, AxisPosition& q, AxisVelocity& qd) noexcept {
  ++periods_;
  intention_.evaluate(static_cast<double>(periods_) * period_s, q, qd);
}

}  // namespace wholehand
