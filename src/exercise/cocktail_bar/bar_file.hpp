#pragma once

#include "exercise/cocktail_bar/bar.hpp"
#include "exercise/exercise_kind.hpp"

namespace wholehand {

/// A level of a bar and its scene: only the dispensers that the level needs, in their row, and the
/// glass under the first one's nozzle.
struct LoadedBar {
  Bar bar;
  SceneModel scene;
};

/// Reads the rest of a bar's file and its scene, and checks one against the other; every fault of
/// both at once. Not real-time safe.
[[nodiscard]] Expected<LoadedBar> loadBar(TomlFile& file, const ExerciseSource& source);

}  // namespace wholehand
