#pragma once

#include "assembly/models.hpp"
#include "patient/motion.hpp"

#include <memory>
#include <string>
#include <vector>

namespace wholehand {

/// Rest pose of the hand: the middle of the arm's ranges and the reference posture.
[[nodiscard]] AxisPosition restPose(const Models& models);

/// The motion of the models, or rest without one. `sentences` (may be null) receives a description
/// of the changes made to the motion.
[[nodiscard]] Intention intentionOf(const Models& models, std::vector<std::string>* sentences);

/// A player that follows intentionOf(), for exercises without a player of their own.
[[nodiscard]] std::unique_ptr<Player> makeMotionPlayer(const Models& models);

}  // namespace wholehand
