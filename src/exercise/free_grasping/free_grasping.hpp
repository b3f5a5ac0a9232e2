#pragma once

#include "exercise/exercise_kind.hpp"

#include <string>

/// Grasping freely: no task, no walls, no effort of its own. Every body is a target of the palm.
namespace wholehand::free_grasping {

[[nodiscard]] Expected<LoadedExercise> load(TomlFile& file, const ExerciseSource& source);

[[nodiscard]] LoadedExercise inScene(SceneModel scene, const std::string& name,
                                     const DeviceModel& device);

}  // namespace wholehand::free_grasping
