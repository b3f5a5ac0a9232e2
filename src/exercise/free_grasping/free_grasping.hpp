#pragma once

#include "exercise/load_exercise.hpp"

/// Free grasping: no task, no walls, no effort. Every body is a target of the palm.
namespace wholehand::free_grasping {

[[nodiscard]] Expected<LoadedExercise> load(TomlFile& file, const ExerciseSource& source);

}  // namespace wholehand::free_grasping
