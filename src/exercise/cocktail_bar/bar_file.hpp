#pragma once

#include "exercise/cocktail_bar/bar.hpp"
#include "exercise/exercise_kind.hpp"

namespace wholehand {

/// A level of a bar and its scene, reduced to the level's dispensers in their row, with the glass
/// under the first nozzle.
struct LoadedBar {
  Bar bar;
  SceneModel scene;
};

/// Reads the rest of a bar's file and its scene, and cross-checks them. Reports every fault of both
/// at once. Not real-time safe.
[[nodiscard]] Expected<LoadedBar> loadBar(TomlFile& file, const ExerciseSource& source);

}  // namespace wholehand
