#pragma once

#include "experiments/exercise_trial.hpp"
#include "page/chart_page.hpp"

namespace wholehand {

/// The paper's Fig. 7: efforts of fingers, thumb and arm, Φ, α, flow and fill over time, with the
/// phases shaded and labelled.
[[nodiscard]] ChartPage exerciseFigure(const ExerciseResult& result);

}  // namespace wholehand
