#pragma once

#include "loop/core/tick_record.hpp"
#include "loop/psychometrics/comparison.hpp"

#include <string>
#include <vector>

namespace wholehand {

/// An answer in a recording.
struct RecordedAnswer {
  Comparison comparison;
  SaidBy by = SaidBy::kSqueeze;
  double time_s = 0.0;
  Mover moved_by = Mover::kNobody;  ///< who moved the hand when it was said
};

/// Collects the answers of an exercise that compares, by the names of its values and events: the
/// event "answered" with x, other, is_catch, said_second and said_by, least_x and most_x. Not
/// real-time safe.
class AnswerLog {
 public:
  AnswerLog(const std::vector<std::string>& value_names,
            const std::vector<std::string>& event_names);

  /// True when the exercise compares.
  [[nodiscard]] bool compares() const noexcept { return answered_ >= 0; }
  void add(const TickRecord& record);

  [[nodiscard]] const std::vector<RecordedAnswer>& answers() const noexcept { return answers_; }
  [[nodiscard]] std::vector<Comparison> comparisons() const;
  /// Least and largest |x| that the exercise offers; 0: none was recorded.
  [[nodiscard]] double least_x() const noexcept { return least_x_; }
  [[nodiscard]] double most_x() const noexcept { return most_x_; }

 private:
  int answered_ = -1, restarted_ = -1;  ///< types of the events
  int x_ = -1, other_ = -1, is_catch_ = -1, said_second_ = -1, said_by_ = -1, least_ = -1,
      most_ = -1;  ///< values
  double least_x_ = 0.0, most_x_ = 0.0;
  std::vector<RecordedAnswer> answers_;
};

}  // namespace wholehand
