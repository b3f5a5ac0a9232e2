#pragma once

#include "exercise/exercise_kind.hpp"

/// The paper's game (§II-F): reach the dispenser of the liquid that the recipe names, grasp it and
/// squeeze until the glass is filled to the line. docs/exercises.md tells its rules.
namespace wholehand::cocktail_bar {

[[nodiscard]] Expected<LoadedExercise> load(TomlFile& file, const ExerciseSource& source);

}  // namespace wholehand::cocktail_bar
