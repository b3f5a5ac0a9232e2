#pragma once

#include "exercise/exercise_kind.hpp"

/// Grasping freely: no task, no walls, no effort of its own. Every body is a target of the palm.
namespace wholehand::free_grasping {

[[nodiscard]] Expected<LoadedExercise> load(TomlFile& file, const ExerciseSource& source);

}  // namespace wholehand::free_grasping
