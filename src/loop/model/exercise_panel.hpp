#pragma once

#include <string>
#include <string_view>
#include <vector>

namespace wholehand {

/// A text in the three languages of the web pages.
struct Words {
  std::string en, fr, de;
};

/// How an exercise's value is displayed. Bounds are in the value's own unit.
struct PanelValue {
  std::string name;     ///< one of ExerciseDescription::value_names
  Words label;          ///< "Your squeeze"
  std::string unit;     ///< as shown: "N", "ml"; empty: dimensionless
  double factor = 1.0;  ///< shown number = value · factor
  int decimals = 0;     ///< decimals of the shown number
  double lower = 0.0, upper = 1.0;
  /// Names of the values that give the current goal band; empty: none.
  std::string goal_lower, goal_upper;
  bool result = false;  ///< its final value is a result, shown in summary, --json and report
};

/// How an event of an exercise is displayed.
struct PanelEvent {
  std::string name;  ///< one of ExerciseDescription::event_names
  Words words;
};

/// Display of an exercise in pages and reports: the table [panel] of its file (docs/exercises.md).
/// Empty when the file has none.
struct ExercisePanel {
  Words title, lead;
  std::vector<Words> instructions;  ///< kInstructionValue is the index of the current one
  std::vector<PanelValue> values;
  std::vector<PanelEvent> events;
};

/// Reserved names of values that pages interpret, if an exercise has them.
inline constexpr std::string_view kInstructionValue = "instruction";  ///< index, -1: none
inline constexpr std::string_view kScoreValue = "score";              ///< 0 .. 100
inline constexpr std::string_view kDoneValue = "done";                ///< 1: finished

}  // namespace wholehand
