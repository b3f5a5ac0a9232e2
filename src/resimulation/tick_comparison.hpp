#pragma once

#include "core/tick_record.hpp"

#include <string>
#include <vector>

namespace wholehand {

/// A dataset in which two ticks differ.
struct TickDifference {
  std::string column;  ///< "coupling", "contacts/force_n"
  int place = 0;       ///< of the first number that differs: an axis, or counted through the rows
  int numbers = 0;     ///< that differ; 0: the two have different counts
  double recorded = 0.0, again = 0.0;  ///< the first two numbers that differ, or the counts
};

/// Compares the recorded tick with the one that was computed again, column by column.
/// @param exact bit by bit; else as a recording keeps them: in single precision, but for what it
/// keeps in double
[[nodiscard]] std::vector<TickDifference> differences(const TickRecord& recorded,
                                                      const TickRecord& again, bool exact);

/// "coupling of thumb_flexion: recorded 1.25, now 1.5, 0.25 more"
[[nodiscard]] std::string describe(const TickDifference& difference,
                                   const std::vector<std::string>& axis_names);

}  // namespace wholehand
