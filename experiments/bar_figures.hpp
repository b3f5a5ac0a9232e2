#pragma once

#include "loop/core/tick_record.hpp"
#include "loop/exercise/exercise.hpp"

#include <array>
#include <cstddef>
#include <string>
#include <vector>

namespace wholehand {

/// Reads figures of the cocktail bar from records. It finds them by their names in the exercise's
/// description.
class BarFigures {
 public:
  enum Figure {
    kStage,
    kScore,
    kSqueeze,
    kFlow,
    kPoured,
    kAsked,
    kTolerance,
    kGlass,
    kSpilt,
    kPouredTotal,
    kStartTotal,
    kCount
  };
  /// Values of "stage".
  static constexpr double kDrinkDone = 4.0, kLevelDone = 5.0;

  explicit BarFigures(const ExerciseDescription& description);

  /// False when the exercise lacks these figures; no other member may then be called.
  [[nodiscard]] bool known() const;
  [[nodiscard]] double operator()(Figure figure, const ExerciseRecord& record) const {
    return record.values[indices_[static_cast<std::size_t>(figure)]];
  }
  /// |poured into glasses + spilt + left - initial volume| [l]
  [[nodiscard]] double volumeError_l(const ExerciseRecord& record) const;
  /// Type of an event by name; -1: none.
  [[nodiscard]] int event(const std::string& name) const;

 private:
  std::array<int, kCount> indices_{};
  std::vector<std::size_t> left_;
  std::vector<std::string> event_names_;
};

}  // namespace wholehand
