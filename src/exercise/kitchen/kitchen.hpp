#pragma once

#include "exercise/load_exercise.hpp"

namespace wholehand::kitchen {

/// Tasks of daily life: steps of a file at things of a scene, which may move on joints.
[[nodiscard]] Expected<LoadedExercise> load(TomlFile& file, const ExerciseSource& source);

}  // namespace wholehand::kitchen
