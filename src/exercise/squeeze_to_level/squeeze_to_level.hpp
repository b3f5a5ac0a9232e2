#pragma once

#include "exercise/exercise_kind.hpp"

/// Squeezing one object to a level: bands of force, each to be held for a while, letting go
/// between. The template of new exercises (docs/exercises.md).
namespace wholehand::squeeze_to_level {

[[nodiscard]] Expected<LoadedExercise> load(TomlFile& file, const ExerciseSource& source);

}  // namespace wholehand::squeeze_to_level
