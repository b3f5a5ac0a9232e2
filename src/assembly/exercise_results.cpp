#include "assembly/exercise_results.hpp"

#include <fmt/format.h>

#include <algorithm>

namespace wholehand {

std::vector<ResultValue> exerciseResults(const Models& models, const TickSummary& summary) {
  std::vector<ResultValue> out;
  if (!models.exercise) return out;
  const std::vector<std::string>& names = models.exercise->description().value_names;
  for (const PanelValue& told : models.exercise_panel.values) {
    const auto at = std::find(names.begin(), names.end(), told.name) - names.begin();
    if (!told.result || at >= summary.value_count) continue;
    const double value = summary.values[at];
    std::string shown =
        fmt::format("{} {:.{}f}", told.label.en, value * told.factor, told.decimals);
    if (!told.unit.empty()) shown += " " + told.unit;
    out.push_back({told.name, value, std::move(shown)});
  }
  return out;
}

}  // namespace wholehand
