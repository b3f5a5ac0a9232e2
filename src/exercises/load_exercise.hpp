#pragma once

#include "exercises/task_needs.hpp"
#include "files/toml/toml_file.hpp"
#include "loop/core/expected.hpp"
#include "loop/exercise/exercise.hpp"
#include "loop/model/device_model.hpp"
#include "loop/model/exercise_panel.hpp"
#include "loop/model/hand_model.hpp"
#include "loop/model/scene_model.hpp"

#include <functional>
#include <memory>
#include <string>
#include <vector>

namespace wholehand {

/// An exercise and its scene.
struct LoadedExercise {
  std::unique_ptr<Exercise> exercise;
  std::vector<ExerciseWall> walls;  ///< empty for an exercise without effort
  TaskNeeds needs;                  ///< of the hand; empty: none is known
  // loadExercise() fills in the rest, for any kind.
  SceneModel scene;                ///< scene of the level; the exercise's body indices refer to it
  std::vector<std::string> files;  ///< paths of the exercise file and the scene file
  ExercisePanel panel;
  /// How far the scene was moved to be within a person's limits.
  Eigen::Vector3d moved_m = Eigen::Vector3d::Zero();
};

/// True when device, gains and hand bear these walls (docs/certificate.md).
using BearsWalls = std::function<bool(const std::vector<ExerciseWall>& walls)>;

/// Input of an exercise kind's loader.
struct ExerciseSource {
  std::string path;                     ///< path of the exercise file
  std::string name;                     ///< name of the exercise
  int level = 1;                        ///< requested level; the kind checks it against the file
  const DeviceModel* device = nullptr;  ///< its ranges are those that the task may use
  const DeviceModel* whole = nullptr;   ///< the same device with its own ranges
  const HandModel* hand = nullptr;
  /// Scene that the file names; the kind adapts it to the level. Null: the scene cannot be loaded,
  /// which loadExercise() reports.
  SceneModel* scene = nullptr;
  /// How far the scene was moved; places that stand in the exercise's file move along.
  Eigen::Vector3d moved_m = Eigen::Vector3d::Zero();
  BearsWalls bears;  ///< empty: not known; a kind then offers all that its file asks
};

/// A kind of exercise: a folder of src/exercises, whose <kind>.cpp defines `load`.
struct ExerciseKind {
  const char* name;
  /// Reads the rest of the file ("kind", "version", "exercise", "name" and "scene" are already
  /// read) and calls its finish() at the end. Reports every fault of the file at once; makes no
  /// exercise without a scene.
  Expected<LoadedExercise> (*load)(TomlFile& file, const ExerciseSource& source);
};

/// Reads an exercise file (kind = "exercise") and its scene (path relative to the file), for a
/// device and a hand. Reports every fault of both files at once. Not real-time safe.
/// @param level 1 .. number of levels
/// @param prescription limits of the person within which the task is placed; null: the device's
[[nodiscard]] Expected<LoadedExercise> loadExercise(const std::string& path, int level,
                                                    const DeviceModel& device,
                                                    const HandModel& hand, BearsWalls bears = {},
                                                    const Prescription* prescription = nullptr);

/// An exercise file in a folder.
struct ExerciseFile {
  std::string name;  ///< file name without .toml, as LoadExercise and --exercise accept
  std::string path;
};
/// Exercise files (*.toml) of a folder, sorted by name; files of another kind are left out. Empty
/// if the folder does not exist.
[[nodiscard]] std::vector<ExerciseFile> listExercises(const std::string& folder);

}  // namespace wholehand
