#pragma once

#include "experiments/exercise_trial.hpp"

#include <string>

namespace wholehand {

/// The paper's Fig. 7 as one SVG that needs nothing else: efforts of fingers, thumb and arm, Φ, α,
/// flow and fill over time, with the phases shaded and numbered.
[[nodiscard]] std::string exerciseFigure(const ExerciseResult& result);

}  // namespace wholehand
