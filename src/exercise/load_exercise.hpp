#pragma once

#include "exercise/exercise_kind.hpp"

#include <string>
#include <vector>

namespace wholehand {

/// Reads an exercise file (kind = "exercise") and its scene (path relative to the file), for a
/// device and a hand. Reports every fault of both files at once. Not real-time safe.
/// @param level 1 .. number of levels
[[nodiscard]] Expected<LoadedExercise> loadExercise(const std::string& path, int level,
                                                    const DeviceModel& device,
                                                    const HandModel& hand);

/// An exercise file in a folder.
struct ExerciseFile {
  std::string name;  ///< file name without .toml, as LoadExercise and --exercise accept
  std::string path;
};
/// Exercise files (*.toml) of a folder by name, without files of another kind. Empty where there is
/// no such folder.
[[nodiscard]] std::vector<ExerciseFile> listExercises(const std::string& folder);

}  // namespace wholehand
