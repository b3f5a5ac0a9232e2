#include "files/exercise/exercise_panel_file.hpp"

#include "files/toml/toml_file.hpp"

#include <algorithm>
#include <array>
#include <cstddef>
#include <optional>

namespace wholehand {
namespace {

bool has(const std::vector<std::string>& names, std::string_view name) {
  return std::find(names.begin(), names.end(), name) != names.end();
}

Words readWords(TomlTable& table, std::string_view key) {
  TomlTable words = table.table(key);
  return {words.text("en"), words.text("fr"), words.text("de")};
}

PanelValue readValue(TomlTable& table) {
  PanelValue out;
  out.name = table.text("name");
  out.label = readWords(table, "label");
  out.unit = table.has("unit") ? table.text("unit") : "";
  out.factor = table.number("factor", above(0.0, 1e9), 1.0);
  out.decimals = static_cast<int>(table.integer("decimals", 0, 6, 0));
  const std::array<double, 2> range = table.interval("range", between(-1e9, 1e9));
  out.lower = range[0];
  out.upper = range[1];
  if (table.has("goal")) {
    const std::vector<std::string> goal = table.texts("goal");
    if (goal.size() == 2) {
      out.goal_lower = goal[0];
      out.goal_upper = goal[1];
    } else if (table.isGood("goal")) {
      table.fail("goal", "is not a pair of values",
                 "write the names of two values: [\"goal_low_n\", \"goal_high_n\"]");
    }
  }
  out.result = table.flag("result", false);
  return out;
}

std::string listed(const std::vector<std::string>& names) {
  std::string out;
  for (const std::string& name : names) out += (out.empty() ? "" : ", ") + name;
  return out.empty() ? "remove it: the exercise has none" : "must be one of: " + out;
}

}  // namespace

ExercisePanel readExercisePanel(TomlTable& panel) {
  ExercisePanel out;
  out.title = readWords(panel, "title");
  out.lead = readWords(panel, "lead");
  for (TomlTable& table : panel.tables("instructions", 0)) {
    out.instructions.push_back({table.text("en"), table.text("fr"), table.text("de")});
  }
  for (TomlTable& table : panel.tables("values", 0)) out.values.push_back(readValue(table));
  if (std::optional<TomlTable> events = panel.optionalTable("events")) {
    for (const std::string& name : events->keys()) {
      out.events.push_back({name, readWords(*events, name)});
    }
  }
  return out;
}

void checkExercisePanel(TomlTable& panel, const ExercisePanel& parsed,
                        const std::vector<std::string>& value_names,
                        const std::vector<std::string>& event_names) {
  std::vector<TomlTable> tables = panel.tables("values", 0);
  for (std::size_t i = 0; i < tables.size(); ++i) {
    const PanelValue& value = parsed.values[i];
    if (!has(value_names, value.name)) {
      tables[i].fail("name", "is not a value of this exercise", listed(value_names));
    }
    for (const std::string& goal : {value.goal_lower, value.goal_upper}) {
      if (!goal.empty() && !has(value_names, goal)) {
        tables[i].fail("goal", "names " + goal + ", which is not a value of this exercise",
                       listed(value_names));
      }
    }
  }
  if (!parsed.instructions.empty() && !has(value_names, kInstructionValue)) {
    panel.fail("instructions", "are never shown: the exercise has no value \"instruction\"",
               "remove them, or choose an exercise with that value");
  }
  if (std::optional<TomlTable> events = panel.optionalTable("events")) {
    for (const PanelEvent& event : parsed.events) {
      if (!has(event_names, event.name)) {
        events->fail(event.name, "is not an event of this exercise", listed(event_names));
      }
    }
  }
}

}  // namespace wholehand
