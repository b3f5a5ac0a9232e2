#pragma once

#include "core/expected.hpp"
#include "exercise/exercise.hpp"
#include "exercise/exercise_wall.hpp"
#include "model/device_model.hpp"
#include "model/exercise_panel.hpp"
#include "model/hand_model.hpp"
#include "model/scene_model.hpp"
#include "model/toml/toml_file.hpp"

#include <memory>
#include <string>
#include <vector>

namespace wholehand {

/// An exercise and the scene it is played in.
struct LoadedExercise {
  std::unique_ptr<Exercise> exercise;
  SceneModel scene;                 ///< of the level; body indices of the exercise are its
  std::vector<std::string> files;   ///< paths of exercise and scene file
  std::vector<ExerciseWall> walls;  ///< empty where it never pushes
  ExercisePanel panel;              ///< loadExercise() reads it, whatever the kind
};

/// What a kind of exercise is loaded from.
struct ExerciseSource {
  std::string path;  ///< of the exercise file
  std::string name;  ///< the exercise's own
  int level = 1;     ///< asked for; the kind checks it against the file
  const DeviceModel* device = nullptr;
  const HandModel* hand = nullptr;
  std::string scene_path;  ///< from the working folder; empty where a fault of it is told
};

/// One kind of exercise: a folder of src/exercise, whose header declares `load`.
struct ExerciseKind {
  const char* name;
  /// Reads the rest of the file ("kind", "version", "exercise", "name" and "scene" are read) and
  /// ends with its finish(): every fault of file and scene at once.
  Expected<LoadedExercise> (*load)(TomlFile& file, const ExerciseSource& source);
};

}  // namespace wholehand
