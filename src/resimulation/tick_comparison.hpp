#pragma once

#include "core/tick_record.hpp"

#include <string>

namespace wholehand {

/// First difference between two ticks.
struct TickDifference {
  std::string field;         ///< "coupling[3]"; empty: identical
  std::string first, again;  ///< the two values, in full precision
};

/// Compares bit by bit every field that is a function of the tick's recorded inputs; clock times
/// are not.
[[nodiscard]] TickDifference firstDifference(const TickRecord& first, const TickRecord& again);

}  // namespace wholehand
