#include "experiments/bar_figures.hpp"

#include <algorithm>
#include <cmath>

namespace wholehand {
namespace {

int indexOf(const std::vector<std::string>& names, const std::string& name) {
  const auto found = std::find(names.begin(), names.end(), name);
  return found == names.end() ? -1 : static_cast<int>(found - names.begin());
}

}  // namespace

BarFigures::BarFigures(const ExerciseDescription& description)
    : event_names_(description.event_names) {
  constexpr std::array<const char*, kCount> kNames = {
      "stage",       "score",   "squeeze_n", "flow_l_s",       "poured_l",     "asked_l",
      "tolerance_l", "glass_l", "spilt_l",   "poured_total_l", "start_total_l"};
  const auto& names = description.value_names;
  for (std::size_t i = 0; i < kNames.size(); ++i) indices_[i] = indexOf(names, kNames[i]);
  for (std::size_t i = 0; i < names.size(); ++i) {
    if (names[i].starts_with("left_l/")) left_.push_back(i);
  }
}

bool BarFigures::known() const {
  return !left_.empty() &&
         std::all_of(indices_.begin(), indices_.end(), [](int i) { return i >= 0; });
}

double BarFigures::volumeError_l(const ExerciseRecord& record) const {
  double sum_l = (*this)(kPouredTotal, record) + (*this)(kSpilt, record);
  for (const std::size_t i : left_) sum_l += record.values[i];
  return std::abs(sum_l - (*this)(kStartTotal, record));
}

int BarFigures::event(const std::string& name) const {
  return indexOf(event_names_, name);
}

}  // namespace wholehand
