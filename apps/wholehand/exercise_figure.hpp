#pragma once

#include "experiments/exercise_trial.hpp"

#include <string>
#include <vector>

namespace wholehand {

/// A picture of a moment: a PNG file, and when.
struct FigureMoment {
  double time_s = 0.0;
  std::string png_path;
};

/// The paper's Fig. 7 as one SVG that needs nothing else: pictures of the moments, then efforts of
/// fingers, thumb and arm, Φ, α, flow and fill over time, with the phases shaded and numbered.
/// Pictures that cannot be read are left out.
[[nodiscard]] std::string exerciseFigure(const ExerciseResult& result,
                                         const std::vector<FigureMoment>& moments);

}  // namespace wholehand
