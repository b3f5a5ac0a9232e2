#pragma once

#include "loop/model/exercise_panel.hpp"

#include <string>
#include <vector>

namespace wholehand {

class TomlTable;

/// Reads the table [panel]. Not real-time safe.
[[nodiscard]] ExercisePanel readExercisePanel(TomlTable& panel);

/// Reports every name in the panel that the exercise does not define.
/// @param panel the table that `parsed` was read from
void checkExercisePanel(TomlTable& panel, const ExercisePanel& parsed,
                        const std::vector<std::string>& value_names,
                        const std::vector<std::string>& event_names);

}  // namespace wholehand
