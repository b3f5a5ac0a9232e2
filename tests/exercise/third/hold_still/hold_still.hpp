#pragma once

#include "exercise/load_exercise.hpp"

/// Holding the hand still for a while: the least exercise that shows that it runs.
namespace wholehand::hold_still {

[[nodiscard]] Expected<LoadedExercise> load(TomlFile& file, const ExerciseSource& source);

}  // namespace wholehand::hold_still
