#include "loop/psychometrics/answer_log.hpp"

#include <algorithm>
#include <cmath>
#include <initializer_list>

namespace wholehand {
namespace {

int indexOf(const std::vector<std::string>& names, const char* name) {
  const auto found = std::find(names.begin(), names.end(), name);
  return found == names.end() ? -1 : static_cast<int>(found - names.begin());
}

}  // namespace

AnswerLog::AnswerLog(const std::vector<std::string>& value_names,
                     const std::vector<std::string>& event_names)
    : answered_(indexOf(event_names, "answered")),
      restarted_(indexOf(event_names, "restarted")),
      x_(indexOf(value_names, "x")),
      other_(indexOf(value_names, "other")),
      is_catch_(indexOf(value_names, "is_catch")),
      said_second_(indexOf(value_names, "said_second")),
      said_by_(indexOf(value_names, "said_by")),
      least_(indexOf(value_names, "least_x")),
      most_(indexOf(value_names, "most_x")) {
  for (const int value : {x_, other_, is_catch_, said_second_, said_by_, least_, most_}) {
    if (value < 0) answered_ = -1;
  }
}

void AnswerLog::add(const TickRecord& record) {
  if (!compares()) return;
  const ExerciseRecord& told = record.exercise;
  for (int i = 0; i < told.event_count; ++i) {
    // A restart begins another block.
    if (told.events[i].type == restarted_) answers_.clear();
    if (told.events[i].type != answered_) continue;
    const auto value = [&](int index) {
      return index < told.value_count ? told.values[index] : 0.0;
    };
    const double x = value(x_), other = value(other_);
    if (!std::isfinite(x) || x == 0.0 || !std::isfinite(other)) continue;
    least_x_ = value(least_);
    most_x_ = value(most_);
    const double by = value(said_by_);
    const auto sayer =
        by >= -1.0 && by < kSayers ? static_cast<SaidBy>(std::lround(by)) : SaidBy::kEarlier;
    answers_.push_back({{x, other, value(said_second_) > 0.5, value(is_catch_) > 0.5},
                        sayer,
                        record.time_s,
                        record.moved_by});
  }
}

std::vector<Comparison> AnswerLog::comparisons() const {
  std::vector<Comparison> out;
  for (const RecordedAnswer& answer : answers_) out.push_back(answer.comparison);
  return out;
}

}  // namespace wholehand
