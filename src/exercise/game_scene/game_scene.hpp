#pragma once

#include "exercise/load_exercise.hpp"

/// A world for the bodies of a game: no task, no walls, no effort. The file's [budget] says how
/// many bodies the game may put into it and how large they are; events report what becomes of them.
namespace wholehand::game_scene {

[[nodiscard]] Expected<LoadedExercise> load(TomlFile& file, const ExerciseSource& source);

}  // namespace wholehand::game_scene
