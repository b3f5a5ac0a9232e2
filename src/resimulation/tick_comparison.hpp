#pragma once

#include "core/tick_record.hpp"

#include <string>

namespace wholehand {

/// Where two ticks differ first.
struct TickDifference {
  std::string field;         ///< "coupling[3]"; empty: they are the same
  std::string first, again;  ///< the two values, to the last digit
};

/// Compares bit by bit all that is a function of a tick's recorded inputs; times on the clock are
/// not.
[[nodiscard]] TickDifference firstDifference(const TickRecord& first, const TickRecord& again);

}  // namespace wholehand
