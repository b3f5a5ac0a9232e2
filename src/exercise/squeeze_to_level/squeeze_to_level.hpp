#pragma once

#include "exercise/load_exercise.hpp"

/// Exercise: squeeze one object to a level. Bands of force, each to hold for a while, with releases
/// between. Template for new exercises (docs/exercises.md).
namespace wholehand::squeeze_to_level {

[[nodiscard]] Expected<LoadedExercise> load(TomlFile& file, const ExerciseSource& source);

}  // namespace wholehand::squeeze_to_level
