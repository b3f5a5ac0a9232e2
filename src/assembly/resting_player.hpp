#pragma once

#include "assembly/models.hpp"
#include "patient/motion.hpp"

#include <memory>
#include <string>
#include <vector>

namespace wholehand {

/// Where the hand is when nobody moves it: the middle of the arm's ranges, the posture of
/// reference.
[[nodiscard]] AxisPosition restPose(const Models& models);

/// The motion of the models, or rest where there is none. `sentences` (may be null) tell what was
/// done to the motion on the way.
[[nodiscard]] Intention intentionOf(const Models& models, std::vector<std::string>* sentences);

/// A player that follows intentionOf(), for exercises without a player of their own.
[[nodiscard]] std::unique_ptr<Player> restingOrPlaying(const Models& models);

}  // namespace wholehand
