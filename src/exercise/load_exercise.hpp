#pragma once

#include "exercise/exercise_kind.hpp"

#include <string>
#include <vector>

namespace wholehand {

/// Reads an exercise file (kind = "exercise") and the scene it names (relative to it), for a device
/// and a hand. Every fault of both files is reported at once. Not real-time safe.
/// @param level 1 .. the exercise's levels
[[nodiscard]] Expected<LoadedExercise> loadExercise(const std::string& path, int level,
                                                    const DeviceModel& device,
                                                    const HandModel& hand);

/// An exercise file of a folder.
struct ExerciseFile {
  std::string name;  ///< of the file, without .toml: what LoadExercise and --exercise accept
  std::string path;
};
/// The exercise files (*.toml) of a folder by name; those of another kind are left out. Empty where
/// there is no such folder.
[[nodiscard]] std::vector<ExerciseFile> listExercises(const std::string& folder);

}  // namespace wholehand
