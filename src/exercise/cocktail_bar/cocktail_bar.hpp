#pragma once

#include "exercise/load_exercise.hpp"

/// The paper's game (§II-F): reach the dispenser of the liquid in the recipe, grasp it and squeeze
/// until the glass is filled to the line. Rules: docs/exercises.md.
namespace wholehand::cocktail_bar {

[[nodiscard]] Expected<LoadedExercise> load(TomlFile& file, const ExerciseSource& source);

}  // namespace wholehand::cocktail_bar
