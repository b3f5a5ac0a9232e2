#pragma once

#include <string>
#include <string_view>
#include <vector>

namespace wholehand {

class TomlTable;

/// A text in the languages of the pages.
struct Words {
  std::string en, fr, de;
};

/// How a value of an exercise is shown to people. Bounds are in the value's own unit.
struct PanelValue {
  std::string name;     ///< of ExerciseDescription::value_names
  Words label;          ///< "Your squeeze"
  std::string unit;     ///< as shown: "N", "ml"; empty: a plain number
  double factor = 1.0;  ///< shown number = value · factor
  int decimals = 0;     ///< of the shown number
  double lower = 0.0, upper = 1.0;
  /// Names of the values that bound the goal band now; empty: it has none.
  std::string goal_lower, goal_upper;
  bool result = false;  ///< what it is at the end counts: summary, --json and report tell it
};

/// How an event of an exercise is told to people.
struct PanelEvent {
  std::string name;  ///< of ExerciseDescription::event_names
  Words words;
};

/// What pages and reports show of an exercise: the table [panel] of its file (docs/exercises.md).
/// Empty where the file has none.
struct ExercisePanel {
  Words title, lead;
  std::vector<Words> instructions;  ///< the value kInstructionValue says which one holds
  std::vector<PanelValue> values;
  std::vector<PanelEvent> events;
};

/// The values that pages know by these names, where an exercise has them.
inline constexpr std::string_view kInstructionValue = "instruction";  ///< index, -1: none
inline constexpr std::string_view kScoreValue = "score";              ///< 0 .. 100
inline constexpr std::string_view kDoneValue = "done";                ///< 1: nothing is left to do

/// Reads the table [panel]. Not for the tick.
[[nodiscard]] ExercisePanel readExercisePanel(TomlTable& panel);

/// Reports every name that the exercise does not have.
/// @param panel the table that `told` was read from
void checkExercisePanel(TomlTable& panel, const ExercisePanel& told,
                        const std::vector<std::string>& value_names,
                        const std::vector<std::string>& event_names);

}  // namespace wholehand
