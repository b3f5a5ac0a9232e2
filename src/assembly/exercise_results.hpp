#pragma once

#include "assembly/models.hpp"
#include "telemetry/statistics.hpp"

#include <string>
#include <vector>

namespace wholehand {

/// A value of the exercise that counts at the end.
struct ResultValue {
  std::string name;    ///< of the value, with its unit
  double value = 0.0;  ///< in that unit, in the last tick that the exercise saw
  std::string shown;   ///< for a person: "Spilt 2 ml"
};

/// The results that the exercise's panel names; empty where no tick had values. Not for the tick.
[[nodiscard]] std::vector<ResultValue> exerciseResults(const Models& models,
                                                       const TickSummary& summary);

}  // namespace wholehand
